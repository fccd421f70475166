#include "estimator/estimator_node.h"

#include "common/bus/channels.h"
#include "estimator/image_decoding.h"

namespace windhover {

EstimatorNode::EstimatorNode(const AircraftConfig& config, const ProcessShare& share,
                             TickClient& client)
    : config_(config), client_(client) {
  if (config_.observe == Observe::kImage) detector_ = MakeDetector(config_.estimator);
  for (std::size_t i = 0; i < config_.aircraft.size(); ++i) {
    const AircraftSelf& aircraft = config_.aircraft[i];
    if (!aircraft.carries_rig || !share.Owns(static_cast<int>(i))) continue;
    Observer& observer = *observers_.emplace_back(std::make_unique<Observer>());
    observer.id = aircraft.id;
    observer.estimators.emplace(config_);
    client_.Require(channel::NavState(aircraft.id), &observer.nav);
    if (detector_) {
      client_.Require(channel::Stereo(aircraft.id), &observer.frame);
    } else {
      client_.Require(channel::Detection(aircraft.id), &observer.detections);
    }
  }
  client_.OnTick([this](const tick_t& tick) { Process(tick); });
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
  const std::vector<stereo_box_t>& boxes = observer->detections.boxes;
  if (tick.phase == tick_t::PHASE_RUN) {
    return observer->estimators->Estimate(tick.utime, observer->nav, boxes);
  }
  // The rehearsal must leave no trace.
  return RigEstimators(config_).Estimate(tick.utime, observer->nav, boxes);
}

}  // namespace windhover
