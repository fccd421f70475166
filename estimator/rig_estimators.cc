#include "estimator/rig_estimators.h"

#include <Eigen/Geometry>

namespace windhover {
namespace {

range_estimate_t ToMessage(const std::optional<RangeSolution>& solution) {
  range_estimate_t estimate{};
  estimate.status = range_estimate_t::STATUS_NO_ESTIMATE;
  if (!solution) return estimate;
  estimate.status = range_estimate_t::STATUS_OK;
  estimate.range_m = solution->range_m;
  estimate.range_sigma_m = solution->range_sigma_m;
  Eigen::Map<Eigen::Vector3d>(estimate.p_RT_m) = solution->p_RT_m;
  estimate.n_stages = solution->n_stages;
  return estimate;
}

}  // namespace

RigEstimators::RigEstimators(const AircraftConfig& config)
    : methods_(config.estimator.methods), rig_(config.rig.ToStereoRig()), X_BR_(config.rig.X_BR()) {
  for (const std::string& method : methods_) {
    estimators_.push_back(MakeRangeEstimator(method, config));
  }
}

range_t RigEstimators::Estimate(Utime utime, const nav_state_t& nav,
                                const std::vector<stereo_box_t>& boxes) {
  StereoObservation observation = ObservedBy(nav);
  observation.utime = utime;
  std::vector<Tracker::Sighting> sightings;
  for (const stereo_box_t& box : boxes) {
    // A box without a ray is no distance either; any fixed direction will do.
    const auto ray = rig_.left.Unproject({box.left.x_px, box.left.y_px});
    sightings.push_back({observation.R_WR * ray.value_or(Eigen::Vector3d::UnitZ()),
                         box.left.w_px / rig_.left.fx_px()});
  }
  const std::vector<int> tracks = tracker_.Assign(utime, sightings);
  range_t range{};
  range.utime = utime;
  range.observer_id = nav.id;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    observation.box = boxes[i];
    observation.track_id = tracks[i];
    for (std::size_t m = 0; m < estimators_.size(); ++m) {
      range_estimate_t estimate = ToMessage(estimators_[m]->Estimate(observation));
      estimate.detection_index = static_cast<int>(i);
      estimate.track_id = tracks[i];
      estimate.method = methods_[m];
      range.estimates.push_back(estimate);
    }
  }
  range.n_estimates = static_cast<int>(range.estimates.size());
  return range;
}

StereoObservation RigEstimators::ObservedBy(const nav_state_t& nav) const {
  const Eigen::Matrix3d R_WB =
      Eigen::Quaterniond(nav.qw, nav.qx, nav.qy, nav.qz).normalized().toRotationMatrix();
  const Eigen::Vector3d lever_velocity_B_mps =
      Eigen::Vector3d(nav.w_WB_B_radps).cross(X_BR_.translation());
  StereoObservation observation;
  observation.R_WR = R_WB * X_BR_.linear();
  observation.v_WR_mps = Eigen::Vector3d(nav.v_WB_mps) + R_WB * lever_velocity_B_mps;
  return observation;
}

}  // namespace windhover
