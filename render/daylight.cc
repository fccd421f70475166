#include "render/daylight.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/rotation.h"
#include "render/procedural_noise.h"

namespace windhover {
namespace {

using Eigen::Vector3f;

// Looks of a sky by the sun's elevation: 9° and more, 0°, -8° and less.
struct Look {
  Vector3f zenith, horizon_sun, horizon_away, surface_light, cloud_light;
};
const Look kDay{{0.13f, 0.27f, 0.58f},
                {0.58f, 0.66f, 0.76f},
                {0.58f, 0.66f, 0.76f},
                {1, 1, 1},
                {0.86f, 0.87f, 0.89f}};
const Look kSunset{{0.11f, 0.17f, 0.34f},
                   {0.90f, 0.44f, 0.16f},
                   {0.40f, 0.34f, 0.38f},
                   {0.62f, 0.42f, 0.28f},
                   {0.78f, 0.44f, 0.28f}};
const Look kBlueHour{{0.035f, 0.065f, 0.17f},
                     {0.26f, 0.20f, 0.21f},
                     {0.09f, 0.13f, 0.23f},
                     {0.13f, 0.18f, 0.28f},
                     {0.12f, 0.15f, 0.23f}};

float Mean(const Vector3f& rgb) { return rgb.sum() / 3; }

Vector3f Mixed(const Vector3f& a, const Vector3f& b, float share_of_b) {
  return a + share_of_b * (b - a);
}

Look Mixed(const Look& a, const Look& b, float share_of_b) {
  return {Mixed(a.zenith, b.zenith, share_of_b), Mixed(a.horizon_sun, b.horizon_sun, share_of_b),
          Mixed(a.horizon_away, b.horizon_away, share_of_b),
          Mixed(a.surface_light, b.surface_light, share_of_b),
          Mixed(a.cloud_light, b.cloud_light, share_of_b)};
}

Look LookAt(float elevation_deg) {
  return Mixed(Mixed(kBlueHour, kSunset, SmoothStep(-8, 0, elevation_deg)), kDay,
               SmoothStep(0, 9, elevation_deg));
}

// The same hour under one grey cloud, which looks alike all around.
Look Overcast(const Look& clear) {
  const Vector3f grey(0.97f, 1.0f, 1.04f);
  const float level = Mean(clear.surface_light);
  return {grey * 0.58f * level, grey * 0.52f * level, grey * 0.52f * level,
          Vector3f(0.70f, 0.72f, 0.75f) * level, grey * 0.55f * level};
}

constexpr double kClearVisibility_m = 10000;
constexpr float kFogDepth_m = 100;

}  // namespace

Daylight::Daylight(const EnvironmentConfig& config) : haze(config.visibility_m) {
  const double azimuth = RadFromDeg(config.sun_azimuth_deg - config.yaw_deg);
  const double elevation = RadFromDeg(config.sun_elevation_deg);
  sun_direction = Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                  std::cos(elevation) * std::sin(azimuth), std::sin(elevation))
                      .cast<float>();
  const auto elevation_deg = static_cast<float>(config.sun_elevation_deg);
  const auto cover = static_cast<float>(config.cloud_cover);
  clouds = cover;
  overcast = SmoothStep(0.5f, 1, cover);
  dusk = (1 - SmoothStep(0, 9, elevation_deg)) * (1 - overcast);
  sun_colour = Mixed({1, 0.55f, 0.22f}, {1, 0.95f, 0.86f}, SmoothStep(0, 12, elevation_deg));
  sun_share = std::fmin(std::fmax(sun_direction.z() * 5, 0.0f), 1.0f) * (1 - overcast) *
              ThroughFog(sun_direction.z());
  const Look clear = LookAt(elevation_deg);
  const Look look = Mixed(clear, Overcast(clear), overcast);
  zenith = look.zenith;
  horizon_sun = look.horizon_sun;
  horizon_away = look.horizon_away;
  surface_light = look.surface_light;
  cloud_light = look.cloud_light;
}

Vector3f Daylight::AirLight(const Eigen::Vector2f& azimuth) const {
  const float level = std::max(sun_direction.head<2>().norm(), 1e-4f);
  const float towards_sun = azimuth.dot(sun_direction.head<2>()) / level;
  const float share = 0.5f + 0.5f * towards_sun;
  return Mixed(horizon_away, horizon_sun, share * share);
}

float Daylight::ThroughFog(float up) const {
  const float more_per_m = haze.Extinction_per_m() - Haze(kClearVisibility_m).Extinction_per_m();
  return std::exp(-std::max(more_per_m, 0.0f) * kFogDepth_m / std::max(up, 0.02f));
}

}  // namespace windhover
