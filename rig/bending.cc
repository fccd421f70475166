#include "rig/bending.h"

#include <numbers>

namespace windhover {

std::complex<double> BendingResponse(const FlexConfig& flex, double frequency_hz) {
  if (!flex.enabled) return 0;
  const double w1 = 2 * std::numbers::pi * flex.frequency_hz;
  const double w = 2 * std::numbers::pi * frequency_hz;
  return -flex.participation / std::complex<double>(w1 * w1 - w * w, 2 * flex.damping * w1 * w);
}

TipMotion BentTip(double forward_m, double up_m, double half_span_m, int side) {
  // Tips that bend forward turn towards each other: the right one about -y. Tips that bend up
  // raise the bar's outer ends: the right one turns about -z. (x right, y down, z forward.)
  return {.shift_m = {0, -up_m, forward_m},
          .turn_rad = {0, -side * TipSlope_rad(forward_m, half_span_m),
                       -side * TipSlope_rad(up_m, half_span_m)}};
}

}  // namespace windhover
