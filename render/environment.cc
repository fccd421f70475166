#include "render/environment.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include "common/geometry/rotation.h"
#include "render/daylight.h"
#include "render/image_environment.h"
#include "render/outdoor_environment.h"

namespace windhover {
namespace {

using Eigen::Vector3f;

// Turns another environment about W's z and scales its light.
class PlacedEnvironment final : public Environment {
 public:
  PlacedEnvironment(std::unique_ptr<Environment> inner, const EnvironmentConfig& config)
      : inner_(std::move(inner)),
        brightness_(static_cast<float>(config.brightness)),
        R_inner_W_(RotationFromVector(Eigen::Vector3d::UnitZ() * -RadFromDeg(config.yaw_deg))
                       .cast<float>()) {}

  Vector3f Radiance(const Vector3f& d_W, float footprint_rad) const override {
    return inner_->Radiance(R_inner_W_ * d_W, footprint_rad) * brightness_;
  }

  void FillRadiance(std::span<const Vector3f> d_W, float footprint_rad,
                    std::span<Vector3f> light) const override {
    std::vector<Vector3f> d_inner;
    d_inner.reserve(d_W.size());
    for (const Vector3f& d : d_W) d_inner.push_back(R_inner_W_ * d);
    inner_->FillRadiance(d_inner, footprint_rad, light);
    for (Vector3f& l : light) l *= brightness_;
  }

  Vector3f AirLight(const Vector3f& d_W) const override {
    return inner_->AirLight(R_inner_W_ * d_W) * brightness_;
  }

 private:
  std::unique_ptr<Environment> inner_;
  float brightness_;
  Eigen::Matrix3f R_inner_W_;
};

std::array<float, 9> Harmonics(const Vector3f& n) {
  const float x = n.x(), y = n.y(), z = n.z();
  return {0.282095f,
          0.488603f * y,
          0.488603f * z,
          0.488603f * x,
          1.092548f * x * y,
          1.092548f * y * z,
          0.315392f * (3 * z * z - 1),
          1.092548f * x * z,
          0.546274f * (x * x - y * y)};
}

}  // namespace

void Environment::FillRadiance(std::span<const Vector3f> d_W, float footprint_rad,
                               std::span<Vector3f> light) const {
  for (std::size_t i = 0; i < d_W.size(); ++i) light[i] = Radiance(d_W[i], footprint_rad);
}

Vector3f Environment::AirLight(const Vector3f&) const {
  constexpr int kDirections = 24;
  Vector3f sum = Vector3f::Zero();
  for (int i = 0; i < kDirections; ++i) {
    sum += Radiance(DirectionFromAngles(i * 360.0 / kDirections, 7), /*footprint_rad=*/0.2f);
  }
  return (sum / kDirections).cwiseMin(1);
}

Vector3f DirectionFromAngles(double azimuth_deg, double elevation_deg) {
  const double azimuth = RadFromDeg(azimuth_deg), elevation = RadFromDeg(elevation_deg);
  return Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                         std::cos(elevation) * std::sin(azimuth), std::sin(elevation))
      .cast<float>();
}

std::unique_ptr<Environment> MakeEnvironment(const EnvironmentConfig& config) {
  std::unique_ptr<Environment> inner;
  switch (config.type) {
    case EnvironmentType::kPlayground:
    case EnvironmentType::kForest:
    case EnvironmentType::kBuildings:
    case EnvironmentType::kBasketballCourt:
      inner = MakeOutdoorEnvironment(config);
      break;
    case EnvironmentType::kPanorama:
      inner = MakePanoramaEnvironment(config.file);
      break;
    case EnvironmentType::kPhoto:
      inner = MakePhotoEnvironment(config.file, config.photo_width_deg);
      break;
  }
  if (inner == nullptr) throw std::logic_error("unknown environment type");
  return std::make_unique<PlacedEnvironment>(std::move(inner), config);
}

SkyLight::SkyLight(const EnvironmentConfig& config, const Environment& environment)
    : sun_direction_W_(DirectionFromAngles(config.sun_azimuth_deg, config.sun_elevation_deg)) {
  harmonics_.fill(Vector3f::Zero());
  constexpr int kRows = 24, kColumns = 48;
  constexpr float kStep_rad = static_cast<float>(EIGEN_PI) / kRows;
  Vector3f mean = Vector3f::Zero();
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const double elevation_deg = 90 - (row + 0.5) * 180 / kRows;
      const Vector3f d = DirectionFromAngles((column + 0.5) * 360.0 / kColumns, elevation_deg);
      const auto solid_angle =
          kStep_rad * kStep_rad * static_cast<float>(std::cos(RadFromDeg(elevation_deg)));
      const Vector3f light = environment.Radiance(d, kStep_rad).cwiseMin(1) * solid_angle;
      const std::array<float, 9> basis = Harmonics(d);
      for (std::size_t i = 0; i < 9; ++i) harmonics_[i] += basis[i] * light;
      mean += light / static_cast<float>(4 * EIGEN_PI);
    }
  }
  const Daylight daylight(config);
  sun_radiance_ = daylight.sun_colour * (2 * mean.mean() * daylight.sun_share);
}

Vector3f SkyLight::AmbientRadiance(const Vector3f& n_W) const {
  // Cosine-lobe convolution, divided by pi for a white surface's radiance.
  constexpr float kBand[9] = {1, 2 / 3.f, 2 / 3.f, 2 / 3.f, 0.25f, 0.25f, 0.25f, 0.25f, 0.25f};
  const std::array<float, 9> basis = Harmonics(n_W);
  Vector3f sum = Vector3f::Zero();
  for (std::size_t i = 0; i < 9; ++i) sum += kBand[i] * basis[i] * harmonics_[i];
  return sum.cwiseMax(0);
}

}  // namespace windhover
