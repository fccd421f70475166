#pragma once

#include <memory>

#include "common/bus/tick_client.h"
#include "common/process/process.h"
#include "lcmtypes/world_truth_t.hpp"
#include "render/key_frames.h"
#include "render/scene_geometry.h"
#include "render/stereo_renderer.h"
#include "scenarios/scenario.h"

namespace windhover {

/// Shows each aircraft with a rig what its cameras see, in the manner of `observe`.
///
///     in   UAV_TRUTH
///     out  ANNOTATION_<id>                               always
///          STEREO_<id>, FRAME_DIGEST_<id>                image, annotated
///          DETECTION_<id>                                truth, geometric, annotated
///          IMAGE_LEFT_<id>, IMAGE_RIGHT_<id>             with `preview`, where there are pixels
class RenderNode {
 public:
  /// Serves the rig-carrying aircraft that `share` owns; `client` must outlive the node.
  /// @throws ConfigError if a file that the scenario names cannot be used.
  /// `frames_dir` takes the key frames for the report; empty: none.
  RenderNode(const Scenario& scenario, const ProcessShare& share, int threads, TickClient& client,
             bool preview = false, const std::filesystem::path& frames_dir = {});
  RenderNode(const RenderNode&) = delete;

 private:
  void OnTick(int tick);
  void PublishPixels(RenderedPair&& pair, int tick);
  void PublishGeometry(const annotation_t& annotation, int tick);

  const Scenario scenario_;
  const bool preview_;
  const KeyFrames key_frames_;
  TickClient& client_;
  world_truth_t world_{};
  std::unique_ptr<StereoRenderer> renderer_;  ///< When observe needs pixels; else geometry_.
  std::unique_ptr<SceneGeometry> geometry_;
};

/// Positions in scenario.aircraft of the aircraft with a rig that `share` owns.
std::vector<int> OwnedObservers(const Scenario& scenario, const ProcessShare& share);

}  // namespace windhover
