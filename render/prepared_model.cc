#include "render/prepared_model.h"

#include <algorithm>
#include <cmath>

#include "render/mesh_visibility.h"

namespace windhover {
namespace {

using Eigen::Vector3f;

constexpr double kMaxEdge_px = 40;
constexpr float kCoarsest_share = 0.25f;  // Longest edge of the first level over the model's size.
constexpr int kLevels = 5;                // Each halves the edges of the one before.

}  // namespace

PreparedModel::PreparedModel(AircraftModel model, double radius_m)
    : radius_m_(radius_m), propellers_(model.propellers), watertight_(model.watertight) {
  const Eigen::AlignedBox3f box = BoundingBox(model.body).merged(BoundingBox(model.rotor_discs));
  const float size_m = box.diagonal().norm();
  DetailLevel level{size_m, std::move(model.body), box, std::move(model.rotor_discs)};
  for (int i = 0; i < kLevels; ++i) {
    level.max_edge_m = size_m * kCoarsest_share / static_cast<float>(1 << i);
    level.body = WithShortEdges(std::move(level.body), level.max_edge_m);
    levels_.push_back(level);
  }
  const Mesh& finest = levels_.back().body;
  open_directions_ = OpenDirections(levels_.front().body, finest);
  for (std::size_t v = 0; v < finest.positions.size(); ++v) {
    ambient_openness_.push_back(AmbientOpenness(open_directions_[v], finest.normals[v]));
  }
}

const DetailLevel& PreparedModel::LevelFor(double depth_m, double focal_px) const {
  const double nearest_m = std::max(depth_m - radius_m_, 0.05);
  for (const DetailLevel& level : levels_) {
    if (level.max_edge_m * focal_px <= kMaxEdge_px * nearest_m) return level;
  }
  return levels_.back();
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
    const float sun = facing > 0 ? facing * towards_sun.Of(model.OpenDirectionsOf(v)) : 0;
    const Vector3f ambient = light.AmbientRadiance(R_WB * n_B) * model.AmbientOpennessOf(v);
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
