#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/shared_frames.h"
#include "common/bus/tick_client.h"
#include "common/process/process.h"
#include "estimator/detector.h"
#include "estimator/rig_estimators.h"
#include "lcmtypes/detection_t.hpp"
#include "lcmtypes/nav_state_t.hpp"
#include "lcmtypes/range_t.hpp"
#include "lcmtypes/stereo_frame_t.hpp"
#include "scenarios/aircraft_config.h"

namespace windhover {

/// Puts detector and range estimators on the bus. For each aircraft i of its share that carries
/// a rig, every tick:
///
///     in   NAV_STATE_i, and STEREO_i (observe: image) or DETECTION_i (else)
///     out  RANGE_i, and DETECTION_i (observe: image)
///
/// RANGE_i has an estimate of every method for every box, sorted by detection, then by method as
/// the scenario lists them.
class EstimatorNode {
 public:
  /// Subscribes through `client`, which must outlive the node's use.
  EstimatorNode(const AircraftConfig& config, const ProcessShare& share, TickClient& client);
  EstimatorNode(const EstimatorNode&) = delete;

 private:
  /// What the node keeps of one aircraft; its messages are filled in by the client.
  struct Observer {
    int id = 0;
    nav_state_t nav{};
    stereo_frame_t frame{};
    detection_t detections{};
    std::optional<RigEstimators> estimators;
  };

  void Process(const tick_t& tick);
  cv::Mat Rgb(const image_t& image);
  void Detect(Observer* observer);
  range_t Estimate(const tick_t& tick, Observer* observer);

  AircraftConfig config_;
  TickClient& client_;
  SharedFrameReader frames_;
  std::unique_ptr<Detector> detector_;                ///< Null unless observe is image.
  std::vector<std::unique_ptr<Observer>> observers_;  ///< By id.
};

}  // namespace windhover
