#pragma once

#include "rig/exposure.h"

namespace windhover {

/// How long a camera exposes and how much it amplifies.
struct ExposureSetting {
  double duration_s;
  double gain = 1;
};

/// A camera's automatic exposure: an integrator of the logarithmic error,
///
///     ln E ← ln E + speed · ln(target / mean light),
///
/// where E is duration times gain; the duration is lengthened first, up to max_ms, then the gain.
class AutoExposure {
 public:
  /// Begins with the nominal duration, within the limits. Stays there if the mode is off.
  AutoExposure(const AutoExposureConfig& config, double nominal_s);

  /// For the next frame.
  ExposureSetting Setting() const;

  /// The last frame's mean linear light, 1 is white.
  void Observe(double mean_light);

 private:
  AutoExposureConfig config_;
  double nominal_s_;
  double log_product_;  ///< ln(duration in s · gain).
};

}  // namespace windhover
