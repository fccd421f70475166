#pragma once

#include "common/config/fields.h"

namespace windhover {

/// What the recursive filter (estimator/self_calibration.h) expects of rig, target and flight.
/// Disparities are of the rig as calibrated; sigmas are standard deviations.
struct SelfcalConfig {
  double offset_sigma_px = 15;
  double offset_walk_pxps = 0.7;
  double size_bias_sigma = 0.15;
  double size_bias_walk_ps = 0.002;
  double size_inflation = 3;
  double acceleration_mps2 = 2;
  double gate_sigma = 3;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("offset_sigma_px", offset_sigma_px, InRange{0, 1000},
            "how far the disparity offset may be from offset1_px at first");
    v.Field("offset_walk_pxps", offset_walk_pxps, InRange{0, 1000},
            "random walk of the disparity offset, px per square root of a second");
    v.Field("size_bias_sigma", size_bias_sigma, InRange{0, 3},
            "how far the target's size may be from what is assumed, relative");
    v.Field("size_bias_walk_ps", size_bias_walk_ps, InRange{0, 3},
            "random walk of that, per square root of a second");
    v.Field("size_inflation", size_inflation, InRange{1, 100},
            "factor on size_sigma, as errors of size last for many frames");
    v.Field("acceleration_mps2", acceleration_mps2, InRange{0, 100},
            "acceleration of targets along the line of sight");
    v.Field("gate_sigma", gate_sigma, InRange{0.1, 100},
            "measurements farther off than this weigh less");
  }
};

}  // namespace windhover
