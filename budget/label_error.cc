#include "budget/label_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/random/random_stream.h"
#include "common/ranging/two_way_ranging.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

// An aircraft with or without a rig, the first there is.
Vector3d Antenna_B_m(const Scenario& scenario, bool carries_rig) {
  Vector3d antenna_m(scenario.uwb.antenna_m.data());
  const auto it =
      std::find_if(scenario.aircraft.begin(), scenario.aircraft.end(),
                   [&](const Aircraft& one) { return one.self.carries_rig == carries_rig; });
  if (it != scenario.aircraft.end()) antenna_m += Vector3d(it->uwb_antenna_m.data());
  return antenna_m;
}

double Exchanged_m(const UwbConfig& uwb, const RangingExchange& exchange) {
  switch (uwb.ranging) {
    case Ranging::kIdeal:
      break;
    case Ranging::kSingleSided:
      return SingleSidedRange_m(exchange);
    case Ranging::kDoubleSided:
      return DoubleSidedRange_m(exchange);
  }
  return exchange.distance_m;
}

// A sample that a label is made of, and how long before the image it was taken.
struct Sample {
  double weight, age_s;
};

std::array<Sample, 2> SamplesFor(const UwbConfig& uwb, double t_s, double late_s) {
  if (uwb.rate_hz <= 0) return {{{1, late_s}, {0, 0}}};
  const double number = (t_s - late_s) * uwb.rate_hz;
  const auto age_s = [&](double k) { return t_s - k / uwb.rate_hz; };
  if (uwb.label == UwbLabel::kNearest) return {{{1, age_s(std::round(number))}, {0, 0}}};
  const double before = std::floor(number), share = number - before;
  return {{{1 - share, age_s(before)}, {share, age_s(before + 1)}}};
}

// What one sample is off by. Draws as often, whatever is switched on.
double Error_m(const UwbConfig& uwb, bool is_obstructed, RandomStream* random) {
  double error_m = uwb.sigma_m * random->Normal();
  const double excess_m = -uwb.nlos_mean_m * std::log1p(-random->Uniform());
  if (is_obstructed) error_m += excess_m;
  const bool is_outlier = random->Uniform() < uwb.outlier_rate;
  const double outlier_m = random->Uniform(-uwb.outlier_m, uwb.outlier_m);
  return is_outlier ? error_m + outlier_m : error_m;
}

}  // namespace

Vector3d AntennaInRig_m(const Scenario& scenario) {
  return scenario.rig.calibrated.X_BR().inverse() * Antenna_B_m(scenario, true);
}

Vector3d AntennaOfTarget_m(const Scenario& scenario) { return Antenna_B_m(scenario, false); }

Vector3d UpInRig(const Scenario& scenario) {
  return scenario.rig.calibrated.X_BR().linear().transpose() * Vector3d::UnitZ();
}

LabelError::LabelError(const Scenario& scenario, std::uint64_t seed)
    : is_used_(scenario.score.reference == ScoreReference::kUwb),
      uwb_(scenario.uwb),
      seed_(seed),
      observer_R_m_(AntennaInRig_m(scenario)),
      up_R_(UpInRig(scenario)) {
  const Vector3d target_m = AntennaOfTarget_m(scenario);
  target_up_m_ = target_m.z();
  target_out_m_ = target_m.head<2>().norm();
  RandomStream random(seed, "budget/label");
  delay_m_ = uwb_.antenna_delay_sigma_m * random.Normal();
  latency_s_ = uwb_.latency_s + uwb_.latency_sigma_s * random.Normal();
  own_ppm_ = uwb_.clock_sigma_ppm * random.Normal();
  target_ppm_ = uwb_.clock_sigma_ppm * random.Normal();
}

double LabelError::At_m(int instant, double t_s, const Vector3d& p_RT_m,
                        const Vector3d& v_mps) const {
  if (!is_used_) return 0;
  constexpr std::uint64_t kDraws = 16;
  RandomStream random(seed_, "budget/label/noise");
  random.Seek(kDraws * static_cast<std::uint64_t>(instant));
  const bool is_obstructed = random.Uniform() < uwb_.nlos_fraction;
  const double heading_rad = random.Uniform(0, 2 * std::numbers::pi);
  const Vector3d out = up_R_.cross(Vector3d::UnitX()).normalized();
  const Vector3d antenna_m =
      target_up_m_ * up_R_ +
      target_out_m_ * (std::cos(heading_rad) * out + std::sin(heading_rad) * up_R_.cross(out));
  double label_m = uwb_.bias_m + delay_m_;
  const double late_s = latency_s_ + 1e-6 * uwb_.drift_ppm * t_s;
  for (const auto& [weight, age_s] : SamplesFor(uwb_, t_s, late_s)) {
    const double taken_s = age_s + uwb_.jitter_s * random.Normal();
    const double distance_m = (p_RT_m - taken_s * v_mps + antenna_m - observer_R_m_).norm();
    const double range_m =
        Exchanged_m(uwb_, {distance_m, own_ppm_, target_ppm_, 1e-6 * uwb_.reply_us});
    const double by_power_m = uwb_.power_bias == 0 ? 0 : uwb_.power_bias * PowerBias_m(distance_m);
    label_m += weight * (range_m + by_power_m + Error_m(uwb_, is_obstructed, &random));
  }
  return label_m - p_RT_m.norm();
}

}  // namespace windhover
