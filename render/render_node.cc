#include "render/render_node.h"

#include <array>
#include <cmath>

#include "common/bus/channels.h"
#include "common/bus/truth_channels.h"
#include "render/box_detector.h"
#include "render/frame_digest.h"

namespace windhover {
namespace {

frame_digest_t DigestOfFrame(const stereo_frame_t& frame) {
  frame_digest_t digest = DigestOf(frame.left, frame.right);
  digest.utime = frame.utime;
  digest.tick = frame.tick;
  digest.observer_id = frame.observer_id;
  return digest;
}

}  // namespace

std::vector<int> OwnedObservers(const Scenario& scenario, const ProcessShare& share) {
  std::vector<int> owned;
  for (int i = 0; i < static_cast<int>(scenario.aircraft.size()); ++i) {
    if (share.Owns(i) && scenario.aircraft[static_cast<std::size_t>(i)].self.carries_rig) {
      owned.push_back(i);
    }
  }
  return owned;
}

RenderNode::RenderNode(const Scenario& scenario, const ProcessShare& share, int threads,
                       TickClient& client, const RenderNodeOptions& options)
    : scenario_(scenario),
      preview_(options.preview),
      shares_frames_(options.shares_frames),
      key_frames_(options.frames_dir,
                  static_cast<int>(std::lround(scenario.duration_s * scenario.frame_rate_hz))),
      client_(client) {
  const std::vector<int> observers = OwnedObservers(scenario, share);
  if (scenario.observe == Observe::kImage || scenario.observe == Observe::kAnnotated) {
    renderer_ = std::make_unique<StereoRenderer>(scenario, observers, threads);
  } else {
    geometry_ = std::make_unique<SceneGeometry>(scenario, observers);
  }
  client_.Require(channel::kUavTruth, &world_);
  client_.OnTick([this](const tick_t& tick) { OnTick(tick.tick); });
}

void RenderNode::OnTick(int tick) {
  if (renderer_ != nullptr) {
    std::vector<RenderedPair> pairs;
    {
      const StageTimer::Scope timing = client_.Timer().Start("render");
      pairs = renderer_->Render(world_, tick);
    }
    for (RenderedPair& pair : pairs) PublishPixels(std::move(pair), tick);
    return;
  }
  const StageTimer::Scope timing = client_.Timer().Start("render");
  geometry_->CheckWorld(world_);
  for (std::size_t i = 0; i < geometry_->Observers().size(); ++i) {
    PublishGeometry(geometry_->Annotate(world_, i), tick);
  }
}

void RenderNode::PublishPixels(RenderedPair&& pair, int tick) {
  key_frames_.Keep(pair, tick);
  const int id = pair.annotation.observer_id;
  stereo_frame_t frame{};
  frame.utime = pair.annotation.utime;
  frame.tick = tick;
  frame.observer_id = id;
  frame.exposure_s = pair.exposure_s;
  const FrameFormat format = FrameFormatOf(scenario_.sensor);
  frame.left = EncodeFrame(std::move(pair.left), frame.utime, format);
  frame.right = EncodeFrame(std::move(pair.right), frame.utime, format);
  client_.Publish(channel::FrameDigest(id), DigestOfFrame(frame));
  client_.Publish(channel::Annotation(id), pair.annotation);
  if (scenario_.observe == Observe::kAnnotated) {
    client_.Publish(channel::Detection(id), DetectVisible(pair.annotation));
  }
  PublishFrame(std::move(frame));
}

void RenderNode::PublishFrame(stereo_frame_t&& frame) {
  const int id = frame.observer_id;
  if (preview_) {
    client_.Publish(channel::ImageLeft(id), frame.left);
    client_.Publish(channel::ImageRight(id), frame.right);
  }
  if (shares_frames_) {
    SharedFrameWriter& shared = shared_frames_[id];
    for (image_t* image : {&frame.left, &frame.right}) renderer_->Recycle(shared.Share(image));
  }
  client_.Publish(channel::Stereo(id), frame);
  if (shares_frames_) return;
  for (image_t* image : {&frame.left, &frame.right}) renderer_->Recycle(std::move(image->data));
}

void RenderNode::PublishGeometry(const annotation_t& annotation, int tick) {
  const int id = annotation.observer_id;
  const CalibratedRig& rig = scenario_.rig.calibrated;
  client_.Publish(channel::Annotation(id), annotation);
  client_.Publish(channel::Detection(id),
                  scenario_.observe == Observe::kTruth
                      ? DetectTruth(annotation, rig.ToStereoRig())
                      : DetectGeometric(annotation, scenario_.geometric, scenario_.random_seed,
                                        tick, rig.image[0], rig.image[1]));
}

}  // namespace windhover
