#pragma once

namespace windhover {

/// Where the image-plane point (0, 0) is in an image, and how large one unit of it is.
struct Intrinsics {
  double fx_px, fy_px;  ///< Focal lengths, > 0.
  double cx_px, cy_px;  ///< Principal point.
};

}  // namespace windhover
