#pragma once

#include <cmath>

namespace windhover {

/// Linear light, 0..1, of an sRGB value, 0..1. Source: IEC 61966-2-1.
inline double LinearFromSrgb(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

/// sRGB value, 0..1, of linear light, 0..1. Source: IEC 61966-2-1.
inline double SrgbFromLinear(double linear) {
  return linear <= 0.0031308 ? linear * 12.92 : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

}  // namespace windhover
