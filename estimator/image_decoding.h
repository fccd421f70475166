#pragma once

#include <cstdint>
#include <span>

#include <opencv2/core.hpp>

#include "lcmtypes/image_t.hpp"

namespace windhover {

/// The image as 8-bit RGB. Formats RGB (without copying: valid while `message` is), GRAY,
/// BAYER_RGGB and MJPEG.
/// @throws std::runtime_error if the format is another, or sizes and data contradict each other.
cv::Mat RgbFromMessage(const image_t& message);
/// The same of a message whose data are elsewhere, in `bytes`.
cv::Mat RgbFromMessage(const image_t& message, std::span<const std::uint8_t> bytes);

}  // namespace windhover
