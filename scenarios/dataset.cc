#include "scenarios/dataset.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "common/geometry/rotation.h"
#include "common/random/random_stream.h"
#include "scenarios/randomize.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr double kNear_m = 20;                ///< Where the shares of distances are split.
constexpr double kSpeed_mps = 2;              ///< Along the line of sight, on average.
constexpr double kWaypoint_s = 0.25;          ///< Between waypoints.
constexpr double kTargetRadius_m = 0.5;       ///< Half of what has to fit into both images.
constexpr double kTargetHalfHeight_m = 0.25;  ///< Likewise, vertically.
constexpr double kMargin_px = 45;             ///< For vibration, drift and tilt.

/// A seeded sine with mean 0.
struct Sway {
  double amplitude, rate_radps, phase_rad;
  Sway(double a, double shortest_s, double longest_s, RandomStream* random)
      : amplitude(a),
        rate_radps(kTwoPi / random->Uniform(shortest_s, longest_s)),
        phase_rad(random->Uniform(0, kTwoPi)) {}
  double At(double t_s) const { return amplitude * std::sin(rate_radps * t_s + phase_rad); }
};

/// The sine of an acceleration with this rms.
Sway Manoeuvre(double rms_mps2, RandomStream* random) {
  Sway sway(0, 2, 3, random);
  sway.amplitude = std::numbers::sqrt2 * rms_mps2 / (sway.rate_radps * sway.rate_radps);
  return sway;
}

/// Distance below which the share `p` of all lies: uniform below and above 20 m.
double Distance_m(const DatasetConfig& dataset, double near_share, double p) {
  if (p < near_share) {
    return dataset.nearest_m + (kNear_m - dataset.nearest_m) * p / near_share;
  }
  return kNear_m + (dataset.farthest_m - kNear_m) * (p - near_share) / (1 - near_share);
}

/// How far from the axis the target's centre may be with all of it in both images, m.
struct Room {
  double right_m, down_m;
};

Room RoomAt(const RigConfig& rig, double depth_m) {
  const double px_per_m = rig.calibrated.FocalPx() / depth_m;
  const double offset_px = std::abs(rig.misalignment.offset_px) / 2;
  const auto room_m = [&](int size_px, double lost_px, double lost_m) {
    return std::max(0.0, (size_px / 2.0 - lost_px) / px_per_m - lost_m);
  };
  return {room_m(rig.calibrated.image[0], kMargin_px + offset_px,
                 rig.calibrated.baseline_m / 2 + kTargetRadius_m),
          room_m(rig.calibrated.image[1], kMargin_px / 2, kTargetHalfHeight_m)};
}

/// The target's path in the rig's axes.
class TargetPath {
 public:
  TargetPath(const Scenario& base, Split split, double duration_s, RandomStream* random)
      : rig_(base.rig),
        dataset_(base.dataset),
        near_share_(base.dataset.Of(split).near_share),
        starts_far_(random->Uniform() < 0.5),
        wander_right_(0.25 * base.rig.calibrated.image[0], 12, 25, random),
        wander_down_(0.2 * base.rig.calibrated.image[1], 9, 20, random),
        // Two directions share the tilt, as the heading turns all the way round.
        manoeuvre_right_(Manoeuvre(Tilt_mps2(), random)),
        manoeuvre_forward_(Manoeuvre(Tilt_mps2(), random)) {
    const double way_m = dataset_.farthest_m - dataset_.nearest_m;
    legs_ = std::max(1.0, std::round(duration_s * kSpeed_mps / way_m));
    duration_s_ = duration_s;
  }

  Vector3d At(double t_s) const {
    const double legs = legs_ * std::clamp(t_s / duration_s_, 0.0, 1.0);
    const double rest = std::fmod(legs, 2.0);
    const double there = rest < 1 ? rest : 2 - rest;  // Of the way, out and back.
    const double p = starts_far_ ? 1 - there : there;
    const double depth_m = Distance_m(dataset_, near_share_, p);
    const Room room = RoomAt(rig_, depth_m);
    const double m_per_px = depth_m / rig_.calibrated.FocalPx();
    const double quick_m =
        std::clamp(manoeuvre_right_.At(t_s), -room.right_m / 2, room.right_m / 2);
    const double right_m =
        std::clamp(m_per_px * wander_right_.At(t_s), -room.right_m / 2, room.right_m / 2);
    const double down_m = std::clamp(m_per_px * wander_down_.At(t_s), -room.down_m, room.down_m);
    const double forward_m =
        std::clamp(depth_m + manoeuvre_forward_.At(t_s), dataset_.nearest_m, dataset_.farthest_m);
    return {right_m + quick_m, down_m, forward_m};
  }

 private:
  double Tilt_mps2() const { return 9.81 * std::tan(RadFromDeg(dataset_.tilt_deg)); }

  RigConfig rig_;
  DatasetConfig dataset_;
  double near_share_;
  double legs_, duration_s_;
  bool starts_far_;
  Sway wander_right_, wander_down_;           ///< px.
  Sway manoeuvre_right_, manoeuvre_forward_;  ///< m.
};

Eigen::Isometry3d PoseOf(const Aircraft& aircraft) {
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
  X_WB.translation() = Vector3d(aircraft.position_m.data());
  X_WB.linear() = RotationFromVector(RadFromDeg(aircraft.yaw_deg) * Vector3d::UnitZ());
  return X_WB;
}

Aircraft Observer(const Scenario& base) {
  const auto it = std::find_if(base.aircraft.begin(), base.aircraft.end(),
                               [](const Aircraft& a) { return a.self.carries_rig; });
  Aircraft observer;
  if (it != base.aircraft.end()) {
    observer = *it;
  } else {
    observer.type = AircraftType::kP600;
    observer.self.carries_rig = true;
    observer.position_m = {0, 0, 20};
  }
  observer.self.id = 0;
  observer.self.controller = Controller::kHold;
  return observer;
}

Aircraft Target(const Scenario& base) {
  const auto first_rig = std::find_if(base.aircraft.begin(), base.aircraft.end(),
                                      [](const Aircraft& a) { return a.self.carries_rig; });
  const auto it = std::find_if(base.aircraft.begin(), base.aircraft.end(), [&](const Aircraft& a) {
    return first_rig != base.aircraft.end() && a.self.id != first_rig->self.id;
  });
  Aircraft target;
  if (it != base.aircraft.end()) target = *it;
  target.self = {};
  target.self.id = 1;
  target.self.controller = Controller::kWaypoints;
  target.trajectory = {};
  return target;
}

std::vector<Waypoint> FlyPath(const TargetPath& path, const Eigen::Isometry3d& X_WR,
                              double duration_s, RandomStream* random) {
  const double heading_deg = random->Uniform(-180, 180);
  const Sway turning(80, 15, 30, random);
  std::vector<Waypoint> waypoints;
  const int n = std::max(1, static_cast<int>(std::ceil(duration_s / kWaypoint_s)));
  for (int i = 0; i <= n; ++i) {
    const double t_s = duration_s * i / n;
    const Vector3d p_W_m = X_WR * path.At(t_s);
    waypoints.push_back({.time_s = t_s,
                         .position_m = {p_W_m.x(), p_W_m.y(), p_W_m.z()},
                         .yaw_deg = heading_deg + turning.At(t_s)});
  }
  return waypoints;
}

// The split says what is around; what `randomize` draws stays as drawn.
void ChooseSurroundings(const std::vector<RandomizedKey>& drawn, Split split, int flight,
                        RandomStream* random, EnvironmentConfig* out) {
  if (out->type == EnvironmentType::kPanorama || out->type == EnvironmentType::kPhoto) return;
  constexpr std::array kTrain = {EnvironmentType::kBuildings, EnvironmentType::kForest,
                                 EnvironmentType::kPlayground};
  out->type = split == Split::kTrain ? kTrain[static_cast<std::size_t>(flight) % kTrain.size()]
                                     : EnvironmentType::kBasketballCourt;
  const auto draw = [&](const char* key, double low, double high, double* value) {
    const double found = random->Uniform(low, high);
    const bool is_drawn = std::any_of(drawn.begin(), drawn.end(), [&](const RandomizedKey& one) {
      return one.key == fmt::format("environment.{}", key);
    });
    if (!is_drawn) *value = found;
  };
  draw("yaw_deg", -180, 180, &out->yaw_deg);
  draw("sun_azimuth_deg", -180, 180, &out->sun_azimuth_deg);
  draw("sun_elevation_deg", 5, 65, &out->sun_elevation_deg);
  draw("cloud_cover", 0, 1, &out->cloud_cover);
  draw("visibility_m", 2000, 20000, &out->visibility_m);
  draw("brightness", 0.8, 1.2, &out->brightness);
}

}  // namespace

Scenario DatasetFlight(const Scenario& base, Split split, int flight, std::uint64_t seed) {
  const char* name = kEnumNames<Split>.names[static_cast<std::size_t>(split)].second;
  const SplitConfig& config = base.dataset.Of(split);
  RandomStream random(seed, fmt::format("dataset/{}/{}", name, flight));
  Scenario scenario = base;
  scenario.description = fmt::format("Flight {} of {}, {}", flight, name, base.description);
  constexpr std::uint64_t kSeeds = 9'000'000'000'000'000;  // As random_seed allows.
  scenario.random_seed = random() % kSeeds;
  scenario = Drawn(std::move(scenario));
  // The pairs that do not divide go to the first flights.
  const int n_pairs = config.pairs / config.flights + (flight < config.pairs % config.flights);
  scenario.duration_s = n_pairs / base.frame_rate_hz;
  const Aircraft observer = Observer(base);
  Aircraft target = Target(base);
  const TargetPath path(scenario, split, scenario.duration_s, &random);
  target.waypoints = FlyPath(path, PoseOf(observer) * scenario.rig.calibrated.X_BR(),
                             scenario.duration_s, &random);
  target.position_m = target.waypoints.front().position_m;
  ChooseSurroundings(base.randomize, split, flight, &random, &scenario.environment);
  scenario.aircraft = {observer, std::move(target)};
  scenario.expect.clear();
  return scenario;
}

}  // namespace windhover
