#include "estimator/estimator_node.h"

#include <Eigen/Geometry>

#include "common/bus/channels.h"
#include "estimator/image_decoding.h"

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

EstimatorNode::EstimatorNode(const AircraftConfig& config, const ProcessShare& share,
                             TickClient& client)
    : config_(config), rig_(config.rig.ToStereoRig()), client_(client) {
  if (config_.observe == Observe::kImage) detector_ = MakeDetector(config_.estimator.detector);
  for (std::size_t i = 0; i < config_.aircraft.size(); ++i) {
    const AircraftSelf& aircraft = config_.aircraft[i];
    if (!aircraft.carries_rig || !share.Owns(static_cast<int>(i))) continue;
    Observer& observer = *observers_.emplace_back(std::make_unique<Observer>());
    observer.id = aircraft.id;
    observer.memory = NewMemory();
    client_.Require(channel::NavState(aircraft.id), &observer.nav);
    if (detector_) {
      client_.Require(channel::Stereo(aircraft.id), &observer.frame);
    } else {
      client_.Require(channel::Detection(aircraft.id), &observer.detections);
    }
  }
  client_.OnTick([this](const tick_t& tick) { Process(tick); });
}

EstimatorNode::Memory EstimatorNode::NewMemory() const {
  Memory memory;
  for (const std::string& method : config_.estimator.methods) {
    memory.estimators.push_back(MakeRangeEstimator(method, config_));
  }
  return memory;
}

void EstimatorNode::Process(const tick_t& tick) {
  for (const auto& observer : observers_) {
    if (detector_) {
      Detect(observer.get());
      client_.Publish(channel::Detection(observer->id), observer->detections);
    }
    client_.Publish(channel::Range(observer->id), Estimate(tick, observer.get()));
  }
}

cv::Mat EstimatorNode::Rgb(const image_t& image) {
  return RgbFromMessage(image, frames_.PixelsOf(image));
}

void EstimatorNode::Detect(Observer* observer) {
  const StageTimer::Scope timed = client_.Timer().Start("detect");
  detection_t& detections = observer->detections;
  detections = detection_t{};
  detections.utime = observer->frame.utime;
  detections.observer_id = observer->id;
  detections.detector = config_.estimator.detector;
  detections.boxes = detector_->Detect(Rgb(observer->frame.left), Rgb(observer->frame.right));
  detections.n_boxes = static_cast<int>(detections.boxes.size());
}

range_t EstimatorNode::Estimate(const tick_t& tick, Observer* observer) {
  const StageTimer::Scope timed = client_.Timer().Start("estimate");
  // The rehearsal must leave no trace: it works on a memory of its own.
  Memory rehearsed;
  if (tick.phase != tick_t::PHASE_RUN) rehearsed = NewMemory();
  Memory& memory = tick.phase == tick_t::PHASE_RUN ? observer->memory : rehearsed;
  const std::vector<int> tracks = memory.tracker.Assign(tick.utime, Sightings(*observer));
  range_t range{};
  range.utime = tick.utime;
  range.observer_id = observer->id;
  StereoObservation observation = ObservedBy(observer->nav);
  observation.utime = tick.utime;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    observation.box = observer->detections.boxes[i];
    observation.track_id = tracks[i];
    for (std::size_t m = 0; m < memory.estimators.size(); ++m) {
      range_estimate_t estimate = ToMessage(memory.estimators[m]->Estimate(observation));
      estimate.detection_index = static_cast<int>(i);
      estimate.track_id = tracks[i];
      estimate.method = config_.estimator.methods[m];
      range.estimates.push_back(estimate);
    }
  }
  range.n_estimates = static_cast<int>(range.estimates.size());
  return range;
}

StereoObservation EstimatorNode::ObservedBy(const nav_state_t& nav) const {
  const Eigen::Isometry3d X_BR = config_.rig.X_BR();
  const Eigen::Matrix3d R_WB =
      Eigen::Quaterniond(nav.qw, nav.qx, nav.qy, nav.qz).normalized().toRotationMatrix();
  const Eigen::Vector3d lever_velocity_B_mps =
      Eigen::Vector3d(nav.w_WB_B_radps).cross(X_BR.translation());
  StereoObservation observation;
  observation.R_WR = R_WB * X_BR.linear();
  observation.v_WR_mps = Eigen::Vector3d(nav.v_WB_mps) + R_WB * lever_velocity_B_mps;
  return observation;
}

std::vector<Tracker::Sighting> EstimatorNode::Sightings(const Observer& observer) const {
  const Eigen::Matrix3d R_WR = ObservedBy(observer.nav).R_WR;
  std::vector<Tracker::Sighting> sightings;
  for (const stereo_box_t& box : observer.detections.boxes) {
    // A box without a ray is no distance either; any fixed direction will do.
    const auto ray = rig_.left.Unproject({box.left.x_px, box.left.y_px});
    sightings.push_back(
        {R_WR * ray.value_or(Eigen::Vector3d::UnitZ()), box.left.w_px / rig_.left.fx_px()});
  }
  return sightings;
}

}  // namespace windhover
