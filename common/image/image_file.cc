#include "common/image/image_file.h"

#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

namespace windhover {

void WriteImageFile(const cv::Mat& image, const std::filesystem::path& file) {
  bool written = false;
  try {
    written = cv::imwrite(file.string(), image);
  } catch (const cv::Exception& error) {
    throw std::runtime_error(fmt::format("{}: {}", file.string(), error.what()));
  }
  if (!written) throw std::runtime_error(fmt::format("{}: cannot be written", file.string()));
}

}  // namespace windhover
