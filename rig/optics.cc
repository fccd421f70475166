#include "rig/optics.h"

#include <algorithm>
#include <cmath>

namespace windhover {
namespace {

AnyCamera With(const AnyCamera& camera, const OpticsConfig& optics,
               const OpticsConfig::OneCamera& own, double focal_m) {
  const double warmer_K = optics.temperature_change_K;
  const double scale = FocusMagnification(focal_m, optics.FocusOf(own)) *
                       (1 + optics.ThermalFocusOf(own) * warmer_K);
  Intrinsics intrinsics = camera.intrinsics();
  intrinsics.fx_px *= scale;
  intrinsics.fy_px *= scale;
  intrinsics.cx_px += own.cx_px_per_K * warmer_K;
  intrinsics.cy_px += own.cy_px_per_K * warmer_K;
  return camera.With(intrinsics);
}

}  // namespace

double OpticsConfig::FocusOf(const OneCamera& camera) const {
  return std::isnan(camera.focus_m) ? focus_m : camera.focus_m;
}

double OpticsConfig::ThermalFocusOf(const OneCamera& camera) const {
  return std::isnan(camera.thermal_focus_per_K) ? thermal_focus_per_K : camera.thermal_focus_per_K;
}

double FocusMagnification(double focal_m, double focus_m) {
  return focus_m == 0 ? 1 : 1 + focal_m / (focus_m - focal_m);
}

StereoRig WithOptics(const StereoRig& calibrated, const OpticsConfig& optics, double focal_m) {
  StereoRig rig = calibrated;
  rig.left = With(rig.left, optics, optics.left, focal_m);
  rig.right = With(rig.right, optics, optics.right, focal_m);
  return rig;
}

double AiryRadius_m(double f_number) { return 1.22 * kWavelength_m * f_number; }

double DiffractionSigma_m(double f_number) { return 0.42 * kWavelength_m * f_number; }

double DefocusDiameter_m(double focal_m, double f_number, double focus_m, double distance_m) {
  const double aperture_m = focal_m / f_number;
  if (focus_m == 0) return aperture_m * focal_m / distance_m;
  // Written in 1 / u, which is 0 at infinity.
  return aperture_m * focal_m * std::abs(1 - focus_m / distance_m) / (focus_m - focal_m);
}

double VignettingFactor(const OpticsConfig& optics, double tangent_squared) {
  if (!optics.vignetting) return 1;
  const double cos2 = 1 / (1 + tangent_squared);
  return std::max(cos2 * cos2 * (1 - optics.vignetting_r2 * tangent_squared), 0.0);
}

}  // namespace windhover
