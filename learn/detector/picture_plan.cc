#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "common/config/enum_name.h"
#include "common/geometry/rotation.h"
#include "common/random/random_stream.h"
#include "learn/detector/picture_scene.h"
#include "render/aircraft_meshes.h"
#include "render/random_meshes.h"
#include "scenarios/dataset.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr double kTwoPi = 2 * std::numbers::pi;
/// Of the rig within a scene. Light from a new direction costs more than all else in a picture.
constexpr double kTurn_deg = 2;
constexpr double kHalfTarget_m = 0.45;  ///< Of an M200, the largest target.

double LogUniform(double low, double high, RandomStream* random) {
  return low * std::pow(high / low, random->Uniform());
}

bool Chance(double share, RandomStream* random) { return random->Uniform() < share; }

std::size_t DrawIndex(std::size_t n, RandomStream* random) {
  return static_cast<std::size_t>(static_cast<double>(n) * random->Uniform());
}

Vector3d Direction(RandomStream* random) {
  const double z = random->Uniform(-1, 1), turn_rad = random->Uniform(0, kTwoPi);
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(turn_rad), r * std::sin(turn_rad), z};
}

/// Something that distracts, and the distances at which it may be.
struct Distractor {
  std::shared_ptr<const AircraftShape> shape;
  double nearest_m, farthest_m;
};

Distractor MakeDistractor(RandomStream* random) {
  const double kind = random->Uniform();
  if (kind < 0.3) return {MakeShape(MakeRandomBird(random)), 5, 90};
  if (kind < 0.5) return {MakeShape(MakeRandomAeroplane(random)), 40, 600};
  if (kind < 0.7) return {MakeShape(MakeRandomTree(random)), 12, 90};
  return {MakeShape(MakeRandomClutter(random)), 5, 60};
}

// Some a process, as making one ready for drawing takes as long as ten pictures.
Distractor DrawDistractor(Split split, RandomStream* random) {
  constexpr std::uint64_t kDistractors = 128;
  static std::mutex mutex;
  static std::map<std::pair<Split, std::uint64_t>, Distractor> made;
  const std::pair key(split, (*random)() % kDistractors);
  const std::scoped_lock lock(mutex);
  const auto known = made.find(key);
  if (known != made.end()) return known->second;
  RandomStream own(key.second, fmt::format("distractor/{}", NameOf(split)));
  return made[key] = MakeDistractor(&own);
}

void RandomiseCamera(RandomStream* random, Scenario* scenario) {
  scenario->flex = {};
  scenario->vibration = {};
  scenario->exposure = {};
  scenario->exposure.duration_ms = LogUniform(0.2, 6, random);
  scenario->exposure.max_blur_px = 1;
  scenario->exposure.max_samples = 9;
  scenario->environment.brightness = LogUniform(0.45, 1.8, random);
  scenario->sensor.full_well_e = LogUniform(2500, 15000, random);
  scenario->sensor.read_noise_e = LogUniform(2, 30, random);
  scenario->sensor.jpeg_quality =
      Chance(0.4, random) ? static_cast<int>(random->Uniform(35, 95)) : 0;
}

Eigen::Quaterniond Attitude(double heading_rad, double tilt_rad, RandomStream* random) {
  const double about_rad = random->Uniform(0, kTwoPi);
  const Vector3d axis(std::cos(about_rad), std::sin(about_rad), 0);
  return Eigen::Quaterniond(RotationFromVector(tilt_rad * axis) *
                            RotationFromVector(heading_rad * Vector3d::UnitZ()));
}

void Place(const Vector3d& p_WB_m, const Eigen::Quaterniond& q_WB, uav_truth_t* uav) {
  Eigen::Map<Vector3d>(uav->p_WB_m) = p_WB_m;
  uav->qw = q_WB.w();
  uav->qx = q_WB.x();
  uav->qy = q_WB.y();
  uav->qz = q_WB.z();
}

void TurnRotors(bool may_stand, RandomStream* random, uav_truth_t* uav) {
  const bool stands = may_stand && Chance(0.05, random);
  const double rate_hz = stands ? 0 : LogUniform(25, 130, random);
  for (int rotor = 0; rotor < 4; ++rotor) {
    uav->rotor_rate_hz[rotor] = rate_hz * random->Uniform(0.85, 1.15);
    uav->rotor_phase_rev[rotor] = random->Uniform();
  }
}

/// Draws where everything is in the pairs of a scene.
class PoseSampler {
 public:
  PoseSampler(const Scenario& scenario, const PictureConfig& config, const Eigen::Matrix3d& R_WB)
      : rig_(scenario.rig.calibrated), config_(config), R_WB_(R_WB) {}

  uav_truth_t Observer(RandomStream* random) const {
    uav_truth_t uav{};
    const double turn_rad = RadFromDeg(random->Uniform(-kTurn_deg, kTurn_deg));
    const Eigen::Matrix3d R_WB = R_WB_ * RotationFromVector(turn_rad * Direction(random));
    Place({0, 0, 20}, Eigen::Quaterniond(R_WB), &uav);
    const double turning_radps = Chance(0.3, random) ? 0 : LogUniform(0.02, 0.8, random);
    Eigen::Map<Vector3d>(uav.w_WB_B_radps) = turning_radps * Direction(random);
    return uav;
  }

  uav_truth_t Target(const uav_truth_t& observer, RandomStream* random) const {
    uav_truth_t uav{};
    const double depth_m = LogUniform(config_.nearest_m, config_.farthest_m, random);
    const bool is_whole = !(config_.is_randomised && Chance(0.1, random));
    const bool is_upright = !(config_.is_randomised && Chance(0.06, random));
    const double tilt_deg = is_upright ? 10 * random->Normal() : random->Uniform(15, 70);
    const double half_m = kHalfTarget_m + rig_.baseline_m / 2;
    Place(InView(observer, depth_m, is_whole ? half_m : 0, random),
          Attitude(random->Uniform(0, kTwoPi), RadFromDeg(tilt_deg), random), &uav);
    Eigen::Map<Vector3d>(uav.v_WB_mps) = random->Uniform(0, 4) * Direction(random);
    TurnRotors(config_.is_randomised, random, &uav);
    return uav;
  }

  uav_truth_t Distracting(const uav_truth_t& observer, double nearest_m, double farthest_m,
                          RandomStream* random) const {
    uav_truth_t uav{};
    const double depth_m = LogUniform(nearest_m, farthest_m, random);
    Place(InView(observer, depth_m, 0, random),
          Attitude(random->Uniform(0, kTwoPi), RadFromDeg(15 * random->Normal()), random), &uav);
    Eigen::Map<Vector3d>(uav.v_WB_mps) = random->Uniform(0, 4) * Direction(random);
    TurnRotors(config_.is_randomised, random, &uav);
    return uav;
  }

  /// Where no camera sees it.
  uav_truth_t Away(const uav_truth_t& observer) const {
    uav_truth_t uav{};
    Place(X_WR(observer) * Vector3d(0, 0, -1000), Eigen::Quaterniond::Identity(), &uav);
    return uav;
  }

 private:
  Eigen::Isometry3d X_WR(const uav_truth_t& observer) const {
    Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
    X_WB.translation() = Vector3d(observer.p_WB_m);
    X_WB.linear() =
        Eigen::Quaterniond(observer.qw, observer.qx, observer.qy, observer.qz).toRotationMatrix();
    return X_WB * rig_.X_BR();
  }

  // Evenly over the image, as long as a ball of `half_m` fits into it.
  Vector3d InView(const uav_truth_t& observer, double depth_m, double half_m,
                  RandomStream* random) const {
    const double m_per_px = depth_m / rig_.FocalPx();
    const auto offset_m = [&](int size_px) {
      const double room_m = std::max(size_px / 2.0 * m_per_px - half_m, 0.0);
      return room_m * random->Uniform(-1, 1);
    };
    const double right_m = offset_m(rig_.image[0]);
    const double down_m = offset_m(rig_.image[1]);
    return X_WR(observer) * Vector3d(right_m, down_m, depth_m);
  }

  CalibratedRig rig_;
  PictureConfig config_;
  Eigen::Matrix3d R_WB_;  ///< Of the rig, give or take kTurn_deg.
};

Scenario Surroundings(const Scenario& base, const PictureConfig& config, int scene,
                      RandomStream* random) {
  Scenario endless = base;
  constexpr int kScenes = std::numeric_limits<int>::max();
  endless.dataset.splits.train = endless.dataset.splits.val =
      endless.dataset.splits.test = {.flights = kScenes, .pairs = kScenes, .near_share = 0.5};
  Scenario scenario = DatasetFlight(endless, config.split, scene, config.seed);
  const std::size_t drawn_types = config.split == Split::kTrain ? 3 : 1;
  const std::size_t chosen = DrawIndex(drawn_types + config.backgrounds.size(), random);
  if (chosen >= drawn_types) {
    const EnvironmentConfig drawn = scenario.environment;
    scenario.environment = config.backgrounds[chosen - drawn_types];
    scenario.environment.yaw_deg = drawn.yaw_deg;
    scenario.environment.brightness = drawn.brightness;
    scenario.environment.sun_azimuth_deg = drawn.sun_azimuth_deg;
    scenario.environment.sun_elevation_deg = drawn.sun_elevation_deg;
  }
  if (config.is_randomised) RandomiseCamera(random, &scenario);
  scenario.render.rasteriser = Rasteriser::kNative;
  return scenario;
}

Aircraft Anybody(int id, TargetKind kind) {
  Aircraft aircraft;
  aircraft.self.id = id;
  aircraft.self.carries_rig = id == 0;
  aircraft.type = kind == TargetKind::kM200Orange  ? AircraftType::kM200Orange
                  : kind == TargetKind::kM200Black ? AircraftType::kM200Black
                                                   : AircraftType::kP600;
  return aircraft;
}

// Of what is no scenario's aircraft.
std::shared_ptr<const AircraftShape> GivenShapeOf(TargetKind kind, RandomStream* random) {
  if (kind == TargetKind::kQuadrotor) return MakeShape(MakeRandomQuadrotor(random));
  if (kind == TargetKind::kHexacopter) return MakeShape(MakeHexacopter());
  if (kind == TargetKind::kFlyingWing) return MakeShape(MakeFlyingWing());
  return nullptr;
}

Eigen::Matrix3d AttitudeOfRig(double heading_rad, RandomStream* random) {
  const double pitch_rad = RadFromDeg(random->Uniform(-18, 14));  // Positive: nose down.
  const double roll_rad = RadFromDeg(6 * random->Normal());
  return RotationFromVector(heading_rad * Vector3d::UnitZ()) *
         RotationFromVector(pitch_rad * Vector3d::UnitY()) *
         RotationFromVector(roll_rad * Vector3d::UnitX());
}

// Photos fill a part of the horizon only, about their yaw.
double HeadingOf(const EnvironmentConfig& environment, RandomStream* random) {
  const double drawn_rad = random->Uniform(0, kTwoPi);
  if (environment.type != EnvironmentType::kPhoto) return drawn_rad;
  return RadFromDeg(environment.yaw_deg) +
         (drawn_rad / kTwoPi - 0.5) * RadFromDeg(environment.photo_width_deg) / 2;
}

}  // namespace

PicturePlan PlanPictures(const Scenario& base, const PictureConfig& config, int scene) {
  const std::string name = fmt::format("pictures/{}/{}", NameOf(config.split), scene);
  RandomStream random(config.seed, name);
  PicturePlan plan;
  plan.scenario = Surroundings(base, config, scene, &random);
  plan.kind = config.targets[DrawIndex(config.targets.size(), &random)];
  plan.scenario.aircraft = {Anybody(0, TargetKind::kP600), Anybody(1, plan.kind)};
  if (auto shape = GivenShapeOf(plan.kind, &random)) plan.shapes[1] = std::move(shape);
  std::vector<Distractor> distractors;
  const std::size_t n = DrawIndex(static_cast<std::size_t>(config.most_distractors) + 1, &random);
  for (std::size_t i = 0; i < n; ++i) {
    distractors.push_back(DrawDistractor(config.split, &random));
    plan.scenario.aircraft.push_back(Anybody(static_cast<int>(2 + i), TargetKind::kP600));
    plan.shapes[2 + i] = distractors.back().shape;
  }
  const double heading_rad = HeadingOf(plan.scenario.environment, &random);
  const PoseSampler poses(plan.scenario, config, AttitudeOfRig(heading_rad, &random));
  for (int pair = 0; pair < config.pairs; ++pair) {
    RandomStream own(config.seed, fmt::format("{}/{}", name, pair));
    world_truth_t world{};
    world.utime = pair * 100'000;
    world.uavs.push_back(poses.Observer(&own));
    const bool is_empty = Chance(config.empty_share, &own);
    world.uavs.push_back(is_empty ? poses.Away(world.uavs[0]) : poses.Target(world.uavs[0], &own));
    for (const Distractor& other : distractors) {
      world.uavs.push_back(Chance(0.5, &own) ? poses.Distracting(world.uavs[0], other.nearest_m,
                                                                 other.farthest_m, &own)
                                             : poses.Away(world.uavs[0]));
    }
    for (std::size_t i = 0; i < world.uavs.size(); ++i) world.uavs[i].id = static_cast<int>(i);
    world.n_uavs = static_cast<std::int32_t>(world.uavs.size());
    plan.worlds.push_back(std::move(world));
  }
  return plan;
}

}  // namespace windhover
