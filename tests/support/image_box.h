#pragma once

#include "lcmtypes/image_box_t.hpp"

namespace windhover {

/// A box by its middle and size.
inline image_box_t Box(double x_px, double y_px, double w_px, double h_px) {
  image_box_t box{};
  box.x_px = x_px;
  box.y_px = y_px;
  box.w_px = w_px;
  box.h_px = h_px;
  return box;
}

}  // namespace windhover
