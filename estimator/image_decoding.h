#pragma once

#include <opencv2/core.hpp>

#include "lcmtypes/image_t.hpp"

namespace windhover {

/// The image as 8-bit RGB. Formats RGB (without copying: valid while `message` is), GRAY,
/// BAYER_RGGB and MJPEG.
/// @throws std::runtime_error if the format is another, or sizes and data contradict each other.
cv::Mat RgbFromMessage(const image_t& message);

}  // namespace windhover
