#pragma once

#include <cmath>
#include <span>

#include <Eigen/Core>

namespace windhover {

/// What the air does to light over a distance: it takes the same share of it every metre and adds
/// its own. Source: H. Koschmieder, "Theorie der horizontalen Sichtweite", 1924; WMO-No. 8, I,
/// 9.1: at the meteorological visibility 2 % of a contrast are left.
class Haze {
 public:
  explicit Haze(double visibility_m)
      : extinction_per_m_(static_cast<float>(-std::log(0.02) / visibility_m)) {}

  float Extinction_per_m() const { return extinction_per_m_; }
  /// Share of the light that is left.
  float Clear(float distance_m) const { return std::exp(-extinction_per_m_ * distance_m); }
  /// `light` as seen through the air, which itself looks like `air` far away.
  Eigen::Vector3f Through(const Eigen::Vector3f& light, const Eigen::Vector3f& air,
                          float distance_m) const {
    return air + Clear(distance_m) * (light - air);
  }
  /// The same for all of `lights`, of one distance.
  void Veil(const Eigen::Vector3f& air, float distance_m, std::span<Eigen::Vector3f> lights) const {
    const float clear = Clear(distance_m);
    for (Eigen::Vector3f& light : lights) light = air + clear * (light - air);
  }

 private:
  float extinction_per_m_;
};

}  // namespace windhover
