#include "common/config/config_writer.h"

#include <filesystem>

namespace windhover {

std::string ConfigWriter::NameOf(const InputFile& file) const {
  switch (style_) {
    case PathStyle::kAbsolute:
      return file.absolute;
    case PathStyle::kNameOnly:
      return std::filesystem::path(file.as_given).filename().string();
    case PathStyle::kAsGiven:
      break;
  }
  return file.as_given;
}

void ConfigWriter::Line(const std::string& key, const std::string& value) {
  std::string indent(static_cast<std::size_t>(depth_) * 2, ' ');
  if (starts_item_) indent.replace(indent.size() - 2, 2, "- ");
  starts_item_ = false;
  text_ += indent + key + ":" + (value.empty() ? "" : " " + value) + "\n";
}

}  // namespace windhover
