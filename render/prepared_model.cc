#include "render/prepared_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/mesh_visibility.h"

namespace windhover {
namespace {

using Eigen::Vector3f;

constexpr double kMaxEdge_px = 40;
constexpr float kCoarsest_share = 0.25f;  // Longest edge of the first level over the model's size.

}  // namespace

PreparedModel::PreparedModel(AircraftModel model, double radius_m)
    : size_m_(BoundingBox(model.body).merged(BoundingBox(model.rotor_discs)).diagonal().norm()),
      model_(std::move(model)),
      radius_m_(radius_m) {}

float PreparedModel::MaxEdge_m(std::size_t level) const {
  return size_m_ * kCoarsest_share / static_cast<float>(1 << level);
}

const DetailLevel& PreparedModel::Level(std::size_t level) const {
  const std::lock_guard<std::mutex> lock(making_level_);
  for (std::size_t i = 0; i <= level; ++i) {
    if (levels_[i] != nullptr) continue;
    auto next = std::make_unique<DetailLevel>();
    next->max_edge_m = MaxEdge_m(i);
    next->body = WithShortEdges(i == 0 ? model_.body : levels_[i - 1]->body, next->max_edge_m);
    next->discs = model_.rotor_discs;
    next->box = BoundingBox(model_.body).merged(BoundingBox(model_.rotor_discs));
    const Mesh& coarsest = i == 0 ? next->body : levels_[0]->body;
    next->open_directions = OpenDirections(coarsest, next->body);
    for (std::size_t v = 0; v < next->body.positions.size(); ++v) {
      next->ambient_openness.push_back(
          AmbientOpenness(next->open_directions[v], next->body.normals[v]));
    }
    levels_[i] = std::move(next);
  }
  return *levels_[level];
}

const DetailLevel& PreparedModel::LevelFor(double depth_m, double focal_px) const {
  const double nearest_m = std::max(depth_m - radius_m_, 0.05);
  std::size_t level = 0;
  while (level + 1 < kLevels && MaxEdge_m(level) * focal_px > kMaxEdge_px * nearest_m) ++level;
  return Level(level);
}

ShadedTarget Shade(const PreparedModel& model, const DetailLevel& level,
                   const Eigen::Matrix3d& R_WB_double, const SkyLight& light) {
  const Eigen::Matrix3f R_WB = R_WB_double.cast<float>();
  const Vector3f sun_B = R_WB.transpose() * light.SunDirection_W();
  const OpennessTowards towards_sun(sun_B);
  ShadedTarget shaded{&model, &level, {}, {}};
  shaded.body_light.reserve(level.body.positions.size());
  shaded.disc_light.reserve(level.discs.positions.size());
  for (std::size_t v = 0; v < level.body.positions.size(); ++v) {
    const Vector3f& n_B = level.body.normals[v];
    const float facing = std::max(n_B.dot(sun_B), 0.0f);
    const float sun = facing > 0 ? facing * towards_sun.Of(level.open_directions[v]) : 0;
    const Vector3f ambient = light.AmbientRadiance(R_WB * n_B) * level.ambient_openness[v];
    shaded.body_light.push_back(
        level.body.base_colours[v].cwiseProduct(sun * light.SunRadiance() + ambient));
  }
  for (std::size_t v = 0; v < level.discs.positions.size(); ++v) {
    const Vector3f n_W = R_WB * level.discs.normals[v];
    const float sun = std::abs(n_W.dot(light.SunDirection_W()));
    shaded.disc_light.push_back(level.discs.base_colours[v].cwiseProduct(
        sun * light.SunRadiance() + light.AmbientRadiance(n_W)));
  }
  return shaded;
}

}  // namespace windhover
