#include "budget/label_error.h"

#include "common/random/random_stream.h"

namespace windhover {

using Eigen::Vector3d;

Vector3d AntennaInRig_m(const Scenario& scenario) {
  const Eigen::Isometry3d X_BR = scenario.rig.calibrated.X_BR();
  return X_BR.inverse() * Vector3d(scenario.uwb.antenna_m.data());
}

LabelError::LabelError(const Scenario& scenario, std::uint64_t seed)
    : is_used_(scenario.score.reference == ScoreReference::kUwb),
      uwb_(scenario.uwb),
      seed_(seed),
      antenna_R_m_(AntennaInRig_m(scenario)) {
  RandomStream random(seed, "budget/label");
  delay_m_ = uwb_.antenna_delay_sigma_m * random.Normal();
  latency_s_ = uwb_.latency_s + uwb_.latency_sigma_s * random.Normal();
}

double LabelError::At_m(int instant, const Vector3d& p_RT_m, const Vector3d& v_mps) const {
  if (!is_used_) return 0;
  RandomStream random(seed_, "budget/label/noise");
  random.Seek(static_cast<std::uint64_t>(instant));
  // A sample taken `latency` ago is stamped now. The target's antenna is at its centre.
  const Vector3d target_R_m = p_RT_m - latency_s_ * v_mps;
  const double distance_m = (target_R_m - antenna_R_m_).norm();
  return distance_m + uwb_.bias_m + delay_m_ + uwb_.sigma_m * random.Normal() - p_RT_m.norm();
}

}  // namespace windhover
