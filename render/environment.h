#pragma once

#include <array>
#include <memory>
#include <span>

#include <Eigen/Core>

#include "scenarios/scenario.h"

namespace windhover {

/// What surrounds the aircraft: radiance by direction, the same from everywhere (no parallax).
/// Any thread may call it.
class Environment {
 public:
  virtual ~Environment() = default;

  /// Radiance from the unit direction `d_W`, linear RGB, 1 is a frame's white; averaged over
  /// about `footprint_rad` so that finer detail does not alias.
  virtual Eigen::Vector3f Radiance(const Eigen::Vector3f& d_W, float footprint_rad) const = 0;

  /// The same from each of many directions near each other, `light[i]` from `d_W[i]`, to the same
  /// bits; what none of them can see costs nothing.
  virtual void FillRadiance(std::span<const Eigen::Vector3f> d_W, float footprint_rad,
                            std::span<Eigen::Vector3f> light) const;

  /// What the air far away looks like towards `d_W`; here: the mean of what is above the horizon.
  virtual Eigen::Vector3f AirLight(const Eigen::Vector3f& d_W) const;
};

/// @throws ConfigError `where: …` if the image of a panorama or photo cannot be used.
std::unique_ptr<Environment> MakeEnvironment(const EnvironmentConfig& config);

/// Light on a diffuse surface, from the sun and from everything else around.
class SkyLight {
 public:
  /// The sun of `config` (render/daylight.h), which by day gives about twice the light of all the
  /// rest of `environment`.
  SkyLight(const EnvironmentConfig& config, const Environment& environment);

  const Eigen::Vector3f& SunDirection_W() const { return sun_direction_W_; }
  /// Radiance of a white diffuse surface that faces the sun, by the sun alone.
  const Eigen::Vector3f& SunRadiance() const { return sun_radiance_; }
  /// Radiance of a white diffuse surface with normal `n_W`, by its surroundings without the sun.
  /// Second-order spherical harmonics. Source: R. Ramamoorthi, P. Hanrahan, "An Efficient
  /// Representation for Irradiance Environment Maps", SIGGRAPH 2001, eq. 10.
  Eigen::Vector3f AmbientRadiance(const Eigen::Vector3f& n_W) const;

 private:
  Eigen::Vector3f sun_direction_W_, sun_radiance_;
  std::array<Eigen::Vector3f, 9> harmonics_;
};

/// The unit vector to azimuth (0 east, 90° north) and elevation in W.
Eigen::Vector3f DirectionFromAngles(double azimuth_deg, double elevation_deg);

}  // namespace windhover
