#pragma once

#include "camera/stereo_rig.h"
#include "common/config/fields.h"

namespace windhover {

/// What the lenses do beyond their calibration. As calibrated, they are focused at infinity and
/// draw points as points.
struct OpticsConfig {
  double focus_m = 0;  ///< 0: infinity.
  double thermal_focus_per_K = 0;
  double temperature_change_K = 0;
  double f_number = 0;  ///< 0: no diffraction, no defocus.
  bool vignetting = false;
  double vignetting_r2 = 0;

  /// Of one camera alone.
  struct OneCamera {
    double focus_m = kUnset, thermal_focus_per_K = kUnset;  ///< Unset: as in OpticsConfig.
    double cx_px_per_K = 0, cy_px_per_K = 0;

    template <typename Visitor>
    void Fields(Visitor& v) {
      v.Field("focus_m", focus_m, Optional{}, "instead of the common focus_m");
      v.Field("thermal_focus_per_K", thermal_focus_per_K, Optional{},
              "instead of the common thermal_focus_per_K");
      v.Field("cx_px_per_K", cx_px_per_K, InRange{-10, 10}, "drift of the principal point, right");
      v.Field("cy_px_per_K", cy_px_per_K, InRange{-10, 10}, "drift of the principal point, down");
    }
  };
  OneCamera left, right;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("focus_m", focus_m, InRange{0, 1e6},
            "distance that the lenses are focused at; 0: infinity, as when calibrated");
    v.Field("thermal_focus_per_K", thermal_focus_per_K, InRange{-0.01, 0.01},
            "relative growth of the focal length with temperature");
    v.Field("temperature_change_K", temperature_change_K, InRange{-100, 100},
            "warmer than when calibrated");
    v.Field("f_number", f_number, InRange{0, 64},
            "focal length by aperture, for diffraction and defocus; 0: neither");
    v.Field("vignetting", vignetting, AnyBool{}, "whether images darken as cos^4 off the axis");
    v.Field("vignetting_r2", vignetting_r2, InRange{-100, 100},
            "further loss of light per squared tangent of the angle off the axis");
    v.Section("left", left, "of the left camera alone");
    v.Section("right", right, "of the right camera alone");
  }

  /// The values that hold for one camera.
  double FocusOf(const OneCamera& camera) const;
  double ThermalFocusOf(const OneCamera& camera) const;
};

/// Image distance over focal length of a lens focused at `focus_m` (0: infinity), 1 + f / (u - f):
/// how much larger everything appears than at infinity. From 1/f = 1/u + 1/v.
double FocusMagnification(double focal_m, double focus_m);

/// The true cameras at rest in place of the calibrated ones: focal lengths and principal points
/// as focus and temperature leave them. `focal_m`: of both lenses.
StereoRig WithOptics(const StereoRig& calibrated, const OpticsConfig& optics, double focal_m);

/// Of the green light in the middle of a camera's band, m.
inline constexpr double kWavelength_m = 550e-9;

/// Radius of the first dark ring around a point's image, 1.22 λ N, m. Source: E. Hecht, "Optics".
double AiryRadius_m(double f_number);

/// Standard deviation of the Gaussian nearest to the middle of that image, 0.42 λ N, m. Source: B.
/// Zhang et al., "Gaussian approximations of fluorescence microscope point-spread function
/// models", Applied Optics 2007.
double DiffractionSigma_m(double f_number);

/// Diameter of the disc that a lens focused at `focus_m` (0: infinity) makes of a point at
/// `distance_m` (infinity too): A f |u - u0| / (u (u0 - f)) with the aperture A = f / N, m.
double DefocusDiameter_m(double focal_m, double f_number, double focus_m, double distance_m);

/// Share of its light that is left `tangent_squared` = tan² off the axis: cos⁴ (1 - v2 tan²), 0
/// at least; 1 without vignetting.
double VignettingFactor(const OpticsConfig& optics, double tangent_squared);

}  // namespace windhover
