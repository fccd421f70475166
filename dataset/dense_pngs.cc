#include "dataset/dense_pngs.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "common/image/image_file.h"

namespace windhover {

void WriteDensePngs(const DenseLabels& labels, const std::filesystem::path& folder) {
  const auto in_256ths = [&](const std::vector<float>& values) {
    cv::Mat image(labels.height_px, labels.width_px, CV_16UC1);
    std::transform(values.begin(), values.end(), image.begin<std::uint16_t>(), [](float value) {
      return static_cast<std::uint16_t>(std::clamp(std::lround(value * 256), 0L, 65535L));
    });
    return image;
  };
  const auto bytes = [&](const std::vector<std::uint8_t>& values) {
    return cv::Mat(labels.height_px, labels.width_px, CV_8UC1,
                   const_cast<std::uint8_t*>(values.data()));
  };
  WriteImageFile(in_256ths(labels.left.depth_m), folder / "depth_left.png");
  WriteImageFile(in_256ths(labels.right.depth_m), folder / "depth_right.png");
  WriteImageFile(in_256ths(labels.disparity_px), folder / "disparity.png");
  WriteImageFile(bytes(labels.left.mask), folder / "mask_left.png");
  WriteImageFile(bytes(labels.right.mask), folder / "mask_right.png");
}

}  // namespace windhover
