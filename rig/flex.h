#pragma once

#include "common/config/fields.h"

namespace windhover {

/// The bar between the cameras: its first bending mode (physical-models, cantilever halves).
struct FlexConfig {
  bool enabled = false;
  double frequency_hz = 117;
  double damping = 0.015;
  double participation = 1.05;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("enabled", enabled, AnyBool{}, "whether the bar bends");
    v.Field("frequency_hz", frequency_hz, InRange{1, 5000}, "first bending mode of a half bar");
    v.Field("damping", damping, InRange{1e-4, 1}, "its modal damping ratio");
    v.Field("participation", participation, InRange{0.1, 3}, "its modal participation factor");
  }
};

}  // namespace windhover
