#pragma once

#include <Eigen/Core>

#include "render/haze.h"
#include "scenarios/render_config.h"

namespace windhover {

/// Light and air of a procedural scene, as a camera shows them that exposes for them: dusk is
/// darker than noon, but not as much as it really is. Below -8° it gets no darker.
struct Daylight {
  explicit Daylight(const EnvironmentConfig& config);

  /// Colour of the air far away, towards `azimuth`: of its direction as (cos, sin).
  Eigen::Vector3f AirLight(const Eigen::Vector2f& azimuth) const;
  /// Share of light from `up`, the sine of an elevation, that comes through fog; 1 at the default
  /// visibility, with which skies were drawn.
  float ThroughFog(float up) const;

  Haze haze;
  Eigen::Vector3f sun_direction;  ///< In the scene, which yaw_deg turns.
  Eigen::Vector3f sun_colour;     ///< Brightest component 1.
  float sun_share;                ///< Of a clear sun's light: less as it sets and behind clouds.
  float clouds;                   ///< 0 none, 1 all over, with gaps.
  float overcast;                 ///< 1: one grey cloud from horizon to horizon.
  float dusk;                     ///< How much the sky is coloured by a low sun.
  Eigen::Vector3f surface_light;  ///< On the ground and all that stands on it; 1 by day.
  Eigen::Vector3f cloud_light;    ///< On clouds, likewise.
  Eigen::Vector3f zenith;
  Eigen::Vector3f horizon_sun, horizon_away;  ///< Of the sky, below the sun and opposite.
};

}  // namespace windhover
