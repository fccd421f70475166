#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "common/config/fields.h"

namespace windhover {

/// Whose noise the boxes have: what the scenario says, or what was measured of its detector.
enum class BoxNoiseSource { kPreset, kFitted };
template <>
inline constexpr EnumNames<BoxNoiseSource> kEnumNames<BoxNoiseSource>{
    {BoxNoiseSource::kPreset, "preset"}, {BoxNoiseSource::kFitted, "fitted"}};

/// Noise of the boxes in `observe: geometric`: how a detector errs that needs no pixels.
struct GeometricConfig {
  BoxNoiseSource noise = BoxNoiseSource::kPreset;
  double sigma_px = 1;
  double sigma_relative = 0.01;
  double size_factor = 1;
  double correlation = 0.5;
  double correlation_width_px = 0;
  double gross_rate = 0;
  double gross_sigma = 0.12;
  double miss_rate = 0;
  double miss_width_px = 0;
  double miss_softness_px = 2;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("noise", noise, AnyEnum{},
            "the values below (preset), or those in estimator.detector_model's card (fitted)");
    v.Field("sigma_px", sigma_px, InRange{0, 100}, "noise of a box's centre");
    v.Field("sigma_relative", sigma_relative, InRange{0, 1}, "the same, per px of box size");
    v.Field("size_factor", size_factor, InRange{0, 10},
            "noise of a box's size relative to its centre's; 2 where its edges err independently");
    v.Field("correlation", correlation, InRange{-1, 1}, "of the left and right noise");
    v.Field("correlation_width_px", correlation_width_px, InRange{0, 10000},
            "width of a box at which what correlation leaves to each image of the noise of x has "
            "twice the variance, as both see another side of a near target; 0: of none");
    v.Field("gross_rate", gross_rate, InRange{0, 1}, "share of boxes that are badly misplaced");
    v.Field("gross_sigma", gross_sigma, InRange{0, 10}, "how far, relative to the box size");
    v.Field("miss_rate", miss_rate, InRange{0, 1}, "share of frames without a detection");
    v.Field("miss_width_px", miss_width_px, InRange{0, 1000},
            "width of a box that is missed half of the time, beyond miss_rate; 0: none is");
    v.Field("miss_softness_px", miss_softness_px, InRange{0.01, 1000},
            "how gradually boxes are missed more as they get narrower");
  }
};

/// Errors of the boxes of one target in both images, px.
struct BoxErrors {
  struct OneImage {
    double x = 0, y = 0, w = 0, h = 0;  ///< Centre and size.
  };
  OneImage left, right;
};

/// Size of a box, px: width, height.
using BoxSize = std::array<double, 2>;

/// How likely a target is missed whose narrower box is `width_px` wide: miss_rate, and a logistic
/// function of the width on top of it.
double MissProbability(const GeometricConfig& config, double width_px);

/// Correlation of the errors in x of the left and right box, `width_px` wide:
/// 1 - (1 - correlation) (1 + (width / correlation_width_px)²), not across 0; its sign stays.
double CorrelationOfX(const GeometricConfig& config, double width_px);

/// The noise of one target's boxes as a function of the tick alone. Each edge of a box errs by
/// hypot(sigma_px, sigma_relative · size) in its centre and by size_factor times that in its
/// size; left and right are correlated. A gross error moves one image's whole box.
class BoxNoise {
 public:
  /// `name` makes its random streams its own ("uav0/geometric/target1").
  BoxNoise(const GeometricConfig& config, std::uint64_t seed, std::string name);

  /// The errors at `tick` (from -1) of boxes of these sizes; nothing: the target is missed.
  std::optional<BoxErrors> At(int tick, const BoxSize& left, const BoxSize& right) const;

 private:
  GeometricConfig config_;
  std::uint64_t seed_;
  std::string name_;
};

}  // namespace windhover
