#pragma once

#include <vector>

#include <Eigen/Core>

#include "common/config/fields.h"

namespace windhover {

/// An image in linear light: 1 is white of an eight-bit file; HDR files may exceed it.
struct LinearImage {
  int width_px = 0, height_px = 0;
  std::vector<Eigen::Vector3f> pixels;  ///< Red, green, blue; rows from the top.
  bool is_hdr = false;                  ///< Radiance without a defined white.

  const Eigen::Vector3f& At(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) +
                  static_cast<std::size_t>(x)];
  }
};

/// Reads PNG, JPEG (sRGB), Radiance HDR or OpenEXR (linear); values that are not finite or
/// negative become 0.
/// @throws ConfigError `where: …` if the file is missing, broken, or beyond 128 Mpx or 1 GiB.
LinearImage ReadLinearImage(const InputFile& file);

}  // namespace windhover
