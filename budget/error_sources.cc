#include <array>
#include <cmath>
#include <utility>

#include "budget/source_lists.h"
#include "common/geometry/rotation.h"

namespace windhover {
namespace {

using D = Disturbance;

/// Range goes with depth at a fixed bearing.
double RangeByDepth(const Sight& at) { return std::hypot(1, (at.x + at.x_right()) / 2, at.y); }

/// The number of a scenario that a constant disturbance is.
using Number = std::function<double&(Scenario*)>;

double Value(const Number& number, Scenario scenario) { return number(&scenario); }

void AddConstant(const Scenario& scenario, D disturbance, const char* key, double unit,
                 const Number& number, ErrorSources* sources) {
  if (Value(number, scenario) == 0) return;
  sources->push_back({.name = RowOf(disturbance).name,
                      .key = key,
                      .law = RowOf(disturbance).law,
                      .switch_on = [number](const Scenario& from,
                                            Scenario* to) { number(to) = Value(number, from); },
                      .first_order =
                          [=](const Scenario& of, const Sight& at) {
                            return OfAmount(disturbance, at, unit * Value(number, of));
                          }});
}

void AddMisalignment(const Scenario& scenario, ErrorSources* sources) {
  const double deg = RadFromDeg(1);
  using M = Misalignment;
  using One = Misalignment::OneCamera;
  const auto relative = [&](D disturbance, const char* key, double unit, double M::*number) {
    AddConstant(
        scenario, disturbance, key, unit,
        [=](Scenario* s) -> double& { return s->rig.misalignment.*number; }, sources);
  };
  const auto own = [&](D disturbance, const char* key, double unit, One M::*camera,
                       double One::*number) {
    AddConstant(
        scenario, disturbance, key, unit,
        [=](Scenario* s) -> double& { return s->rig.misalignment.*camera.*number; }, sources);
  };
  relative(D::kOffset, "rig.misalignment.offset_px", 1, &M::offset_px);
  relative(D::kRelativeYaw, "rig.misalignment.yaw_deg", deg, &M::yaw_deg);
  relative(D::kRelativePitch, "rig.misalignment.pitch_deg", deg, &M::pitch_deg);
  relative(D::kRelativeRoll, "rig.misalignment.roll_deg", deg, &M::roll_deg);
  own(D::kLeftYaw, "rig.misalignment.left.yaw_deg", deg, &M::left, &One::yaw_deg);
  own(D::kLeftPitch, "rig.misalignment.left.pitch_deg", deg, &M::left, &One::pitch_deg);
  own(D::kLeftRoll, "rig.misalignment.left.roll_deg", deg, &M::left, &One::roll_deg);
  own(D::kLeftCx, "rig.misalignment.left.cx_px", 1, &M::left, &One::cx_px);
  own(D::kRightYaw, "rig.misalignment.right.yaw_deg", deg, &M::right, &One::yaw_deg);
  own(D::kRightPitch, "rig.misalignment.right.pitch_deg", deg, &M::right, &One::pitch_deg);
  own(D::kRightRoll, "rig.misalignment.right.roll_deg", deg, &M::right, &One::roll_deg);
  own(D::kRightCx, "rig.misalignment.right.cx_px", 1, &M::right, &One::cx_px);
}

void AddRemounting(const Scenario& scenario, ErrorSources* sources) {
  const Misalignment::Random& random = scenario.rig.misalignment.random;
  const RelativeAngles angles{
      .mean_deg = {},
      .sigma_deg = {random.pitch_sigma_deg, random.yaw_sigma_deg, random.roll_sigma_deg}};
  // A uniform offset within ±a has a deviation of a / √3.
  const double offset_px =
      std::hypot(random.offset_sigma_px, random.offset_spread_px / std::sqrt(3));
  if (offset_px == 0 && angles.sigma_deg == std::array<double, 3>{}) return;
  sources->push_back(
      {.name = "remounting between flights",
       .key = "rig.misalignment.random",
       .law = DistanceLaw::kSquare,
       .switch_on =
           [](const Scenario& from, Scenario* to) {
             to->rig.misalignment.random = from.rig.misalignment.random;
           },
       .first_order = [=](const Scenario&,
                          const Sight& at) { return OfAngles(angles, at, offset_px); }});
}

}  // namespace

Eigen::Vector3d DirectionOf(const Sight& at) {
  return Eigen::Vector3d((at.x + at.x_right()) / 2, at.y, 1).normalized();
}

double RangeRate_mps(const Sight& at) { return at.v_mps.dot(DirectionOf(at)); }

Effect OfDisparity(const Sight& at, double mean_px, double sigma_px) {
  const double by_depth = RangeByDepth(at);
  const double mean = std::abs(mean_px) / at.disparity_px(), sigma = sigma_px / at.disparity_px();
  return {by_depth * (DepthError_m(at, mean_px) + InverseDisparityBias_m(at, sigma_px)),
          by_depth * std::abs(DepthError_m(at, sigma_px)), mean + 4 * sigma * sigma};
}

Effect OfAmount(Disturbance disturbance, const Sight& at, double amount) {
  return OfDisparity(at, RowOf(disturbance).disparity_px(at) * amount, 0);
}

Effect OfAngles(const RelativeAngles& angles, const Sight& at, double noise_px) {
  constexpr std::array kAxes = {D::kRelativePitch, D::kRelativeYaw, D::kRelativeRoll};
  double mean_px = 0, variance_px2 = noise_px * noise_px;
  for (std::size_t i = 0; i < 3; ++i) {
    const double px_per_deg = RadFromDeg(RowOf(kAxes[i]).disparity_px(at));
    mean_px += px_per_deg * angles.mean_deg[i];
    variance_px2 += std::pow(px_per_deg * angles.sigma_deg[i], 2);
  }
  return OfDisparity(at, mean_px, std::sqrt(variance_px2));
}

std::vector<ErrorSource> ErrorSourcesOf(const Scenario& scenario) {
  ErrorSources sources;
  AddMisalignment(scenario, &sources);
  AddRemounting(scenario, &sources);
  AddLensSources(scenario, &sources);
  AddShutterSources(scenario, &sources);
  AddBarSources(scenario, &sources);
  AddBoxSources(scenario, &sources);
  AddLabelSources(scenario, &sources);
  return sources;
}

Scenario InOrder(const Scenario& scenario) {
  Scenario order = scenario;
  order.rig.misalignment = {};
  order.flex = {};
  order.vibration = {};
  order.geometric = {};
  order.optics = {};
  order.exposure.shutter = Shutter::kGlobal;
  order.exposure.skew_ms = order.exposure.jitter_ms = 0;
  order.geometric.sigma_px = order.geometric.sigma_relative = 0;
  // Antennas in the middle of the aircraft, and the middle of the baseline there too.
  order.uwb = {};
  order.uwb.sigma_m = 0;
  for (Aircraft& aircraft : order.aircraft) aircraft.uwb_antenna_m = {0, 0, 0};
  order.rig.calibrated.mount.position_m = {0, 0, 0};
  order.score.reference = ScoreReference::kRange;
  return order;
}

}  // namespace windhover
