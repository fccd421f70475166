#include "dataset/yolo_layout.h"

#include <fmt/format.h>

#include "common/config/enum_name.h"
#include "common/file/whole_file.h"
#include "dataset/box_text.h"

namespace windhover {

namespace fs = std::filesystem;

StereoFiles YoloLayout::ImageFiles(const PairId& id) const {
  const fs::path folder = fs::path("images") / NameOf(id.split);
  return {folder / (StemOf(id) + "_left.jpg"), folder / (StemOf(id) + "_right.jpg")};
}

void YoloLayout::Add(const LabelledPair& pair) {
  splits_.insert(pair.id.split);
  const fs::path labels = folder_ / "labels" / NameOf(pair.id.split);
  const std::string stem = StemOf(pair.id);
  ReplaceFile(WithFolders(labels / (stem + "_left.txt")),
              VisibleBoxes(pair, &target_annotation_t::left));
  ReplaceFile(labels / (stem + "_right.txt"), VisibleBoxes(pair, &target_annotation_t::right));
}

void YoloLayout::Finish() {
  std::string yaml = "path: .\n";
  for (const Split split : splits_) {
    yaml += fmt::format("{0}: images/{0}\n", NameOf(split));
  }
  ReplaceFile(folder_ / "data.yaml", yaml + "nc: 1\nnames: [uav]\n");
}

}  // namespace windhover
