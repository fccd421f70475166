#pragma once

#include <vector>

#include "camera/pinhole_radtan.h"

namespace windhover::test {

/// Cameras that every camera-model test runs on.
template <typename Model>
std::vector<Model> ExampleCameras();

/// The EuRoC MAV data set's cam0, the same lens without distortion, a 12 mm lens with all five
/// terms at 3215 px, and a strong barrel.
template <>
inline std::vector<PinholeRadtan> ExampleCameras() {
  return {{.fx_px = 458.654, .fy_px = 457.296, .cx_px = 367.215, .cy_px = 248.375},
          {.fx_px = 458.654,
           .fy_px = 457.296,
           .cx_px = 367.215,
           .cy_px = 248.375,
           .k1 = -0.28340811,
           .k2 = 0.07395907,
           .p1 = 0.00019359,
           .p2 = 1.76187114e-05},
          {.fx_px = 3215,
           .fy_px = 3214,
           .cx_px = 639.5,
           .cy_px = 359.5,
           .k1 = -0.1,
           .k2 = 0.3,
           .p1 = 1e-3,
           .p2 = -5e-4,
           .k3 = 0.05},
          {.fx_px = 900, .fy_px = 900, .cx_px = 639.5, .cy_px = 359.5, .k1 = -0.4, .k2 = 0.15}};
}

}  // namespace windhover::test
