#include "common/image/image_file.h"

#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "common/image/image_codecs.h"

namespace windhover {

void WriteImageFile(const cv::Mat& image, const std::filesystem::path& file) {
  bool written = false;
  try {
    written = Codecs().imwrite(file.string(), image, {});
  } catch (const cv::Exception& error) {
    throw std::runtime_error(fmt::format("{}: {}", file.string(), error.what()));
  }
  if (!written) throw std::runtime_error(fmt::format("{}: cannot be written", file.string()));
}

}  // namespace windhover
