#pragma once

#include <filesystem>
#include <map>
#include <memory>

#include "common/bus/shared_frames.h"
#include "common/bus/tick_client.h"
#include "common/process/process.h"
#include "lcmtypes/stereo_frame_t.hpp"
#include "lcmtypes/world_truth_t.hpp"
#include "render/key_frames.h"
#include "render/scene_geometry.h"
#include "render/stereo_renderer.h"
#include "scenarios/scenario.h"

namespace windhover {
struct RenderNodeOptions {
  bool preview = false;                   ///< Also bare images for viewers.
  bool shares_frames = false;             ///< Pixels travel through shared memory.
  std::filesystem::path frames_dir = {};  ///< Takes the key frames for the report; empty: none.
};

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
  RenderNode(const Scenario& scenario, const ProcessShare& share, int threads, TickClient& client,
             const RenderNodeOptions& options = {});
  RenderNode(const RenderNode&) = delete;

 private:
  void OnTick(int tick);
  void PublishPixels(RenderedPair&& pair, int tick);
  void PublishFrame(stereo_frame_t&& frame);
  void PublishGeometry(const annotation_t& annotation, int tick);

  const Scenario scenario_;
  const bool preview_, shares_frames_;
  const KeyFrames key_frames_;
  TickClient& client_;
  world_truth_t world_{};
  std::map<int, SharedFrameWriter> shared_frames_;  ///< By observer.
  std::unique_ptr<StereoRenderer> renderer_;        ///< When observe needs pixels; else geometry_.
  std::unique_ptr<SceneGeometry> geometry_;
};

/// Positions in scenario.aircraft of the aircraft with a rig that `share` owns.
std::vector<int> OwnedObservers(const Scenario& scenario, const ProcessShare& share);

}  // namespace windhover
