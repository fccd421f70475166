#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "common/time/sim_time.h"
#include "lcmtypes/image_t.hpp"

namespace windhover {

/// Eight bits each of red, green and blue (sRGB), rows from the top without gaps.
struct RgbImage {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> pixels;  ///< width · height · 3.

  RgbImage() = default;
  RgbImage(int width, int height)
      : width_px(width),
        height_px(height),
        pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3) {}

  std::uint8_t* Row(int y) { return pixels.data() + RowOffset(y); }
  const std::uint8_t* Row(int y) const { return pixels.data() + RowOffset(y); }

 private:
  std::size_t RowOffset(int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) * 3;
  }
};

/// The image as a message; takes the pixels over without copying.
image_t MessageFromImage(RgbImage&& image, Utime utime);

/// The pixels of a message of format RGB.
/// @throws std::runtime_error if its sizes contradict each other or its format is another.
RgbImage ImageFromMessage(const image_t& message);

/// Writes PNG or JPEG, by the file's extension. @throws std::runtime_error if it cannot.
void WriteImage(const RgbImage& image, const std::filesystem::path& file);

}  // namespace windhover
