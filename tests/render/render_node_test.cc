#include "render/render_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <xxhash.h>

#include "common/bus/channels.h"
#include "common/bus/truth_channels.h"
#include "lcmtypes/detection_t.hpp"
#include "lcmtypes/frame_digest_t.hpp"
#include "lcmtypes/stereo_frame_t.hpp"
#include "lcmtypes/tick_done_t.hpp"
#include "render/snapshot.h"
#include "tests/render/render_examples.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

/// One render node on an in-process bus, fed with the example world.
class RenderNodeTest : public testing::Test {
 protected:
  void Run(Observe observe, ProcessShare share = {}, bool preview = false) {
    RenderNode node(ExampleScenario(observe), share, 1, client_,
                    {.preview = preview, .frames_dir = {}});
    for (const int id : {0, 1, 2, 3}) {
      Keep(channel::Stereo(id), &frames_);
      Keep(channel::FrameDigest(id), &digests_);
      Keep(channel::Annotation(id), &annotations_);
      Keep(channel::Detection(id), &detections_);
      Keep(channel::ImageLeft(id), &previews_);
      Keep(channel::ImageRight(id), &previews_);
    }
    Keep(channel::kTickDone, &done_);
    tick_t tick{};
    tick.utime = 300'000;
    tick.tick = 3;
    tick.run_id = 5;
    tick.phase = tick_t::PHASE_RUN;
    bus_.Publish(channel::kTick, tick);
    bus_.Publish(channel::kUavTruth, ExampleWorld());
    while (bus_.Handle(0)) continue;
  }

  template <typename Message>
  void Keep(const std::string& channel, std::vector<Message>* messages) {
    bus_.Subscribe<Message>(channel, [messages](const Message& m) { messages->push_back(m); });
  }

  Bus bus_{"memq://"};
  TickClient client_{bus_, "render-0", 5};
  std::vector<stereo_frame_t> frames_;
  std::vector<frame_digest_t> digests_;
  std::vector<annotation_t> annotations_;
  std::vector<detection_t> detections_;
  std::vector<image_t> previews_;
  std::vector<tick_done_t> done_;
};

std::vector<int> ObserversOf(const auto& messages) {
  std::vector<int> ids;
  for (const auto& message : messages) ids.push_back(message.observer_id);
  return ids;
}

TEST_F(RenderNodeTest, ImageModePublishesFramesDigestsAndTruth) {
  Run(Observe::kImage);
  EXPECT_THAT(ObserversOf(frames_), ElementsAre(0, 2));
  EXPECT_THAT(ObserversOf(digests_), ElementsAre(0, 2));
  EXPECT_THAT(ObserversOf(annotations_), ElementsAre(0, 2));
  EXPECT_THAT(detections_, IsEmpty());
  EXPECT_THAT(previews_, IsEmpty());
  EXPECT_THAT(done_, SizeIs(1));
  const stereo_frame_t& frame = frames_[0];
  EXPECT_EQ(frame.utime, 300'000);
  EXPECT_EQ(frame.tick, 3);
  EXPECT_EQ(frame.exposure_s, 0.002);
  EXPECT_EQ(frame.left.width, 640);
  EXPECT_EQ(frame.left.row_stride, 1920);
  EXPECT_EQ(frame.right.size, 640 * 360 * 3);
  EXPECT_NE(frame.left.data, frame.right.data);
  const XXH128_hash_t hash = XXH3_128bits(frame.right.data.data(), frame.right.data.size());
  EXPECT_EQ(digests_[0].right_xxh3[0], static_cast<std::int64_t>(hash.high64));
  EXPECT_EQ(digests_[0].right_xxh3[1], static_cast<std::int64_t>(hash.low64));
}

TEST_F(RenderNodeTest, AnnotatedModeAddsVisibleBoxes) {
  Run(Observe::kAnnotated);
  ASSERT_THAT(detections_, SizeIs(2));
  ASSERT_EQ(detections_[0].n_boxes, 2);
  EXPECT_EQ(detections_[0].boxes[0].left.x_px, annotations_[0].targets[0].left.visible.x_px);
  EXPECT_THAT(frames_, SizeIs(2));
}

TEST_F(RenderNodeTest, GeometricModeNeedsNoPixels) {
  Run(Observe::kGeometric);
  EXPECT_THAT(frames_, IsEmpty());
  EXPECT_THAT(digests_, IsEmpty());
  EXPECT_THAT(ObserversOf(detections_), ElementsAre(0, 2));
  EXPECT_THAT(ObserversOf(annotations_), ElementsAre(0, 2));
  EXPECT_EQ(detections_[0].n_boxes, 2);
}

TEST_F(RenderNodeTest, TruthModePublishesExactBoxes) {
  Run(Observe::kTruth);
  ASSERT_THAT(detections_, SizeIs(2));
  EXPECT_EQ(detections_[0].detector, "truth");
}

TEST_F(RenderNodeTest, ServesItsShareAlone) {
  Run(Observe::kGeometric, {.index = 2, .count = 3});
  EXPECT_THAT(ObserversOf(detections_), ElementsAre(2));
}

TEST_F(RenderNodeTest, PreviewsBareImages) {
  Run(Observe::kImage, {.index = 0, .count = 4}, /*preview=*/true);
  ASSERT_THAT(previews_, SizeIs(2));
  EXPECT_EQ(previews_[0].data, frames_[0].left.data);
  EXPECT_EQ(previews_[1].data, frames_[0].right.data);
}

TEST(FullBoxes, AreTheSameWithAndWithoutPixels) {
  Scenario scenario = ExampleScenario(Observe::kAnnotated);
  scenario.flex.enabled = true;
  scenario.vibration.source = VibrationSource::kPsd;
  const annotation_t drawn =
      StereoRenderer(scenario, {0}, 1).Render(ExampleWorld(), 3)[0].annotation;
  const annotation_t computed = SceneGeometry(scenario, {0}).Annotate(ExampleWorld(), 0);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(drawn.targets[i].left.full.x_px, computed.targets[i].left.full.x_px);
    EXPECT_EQ(drawn.targets[i].right.full.w_px, computed.targets[i].right.full.w_px);
    EXPECT_EQ(drawn.targets[i].range_m, computed.targets[i].range_m);
  }
}

TEST(Snapshot, WritesImagesAndLabels) {
  const TemporaryFolder folder;
  const Scenario scenario = ExampleScenario(Observe::kImage);
  WriteSnapshot(scenario, ExampleWorld(), 1, folder.path() / "a" / "b");
  for (const char* name : {"left.png", "right.png", "labels.json"}) {
    EXPECT_GT(std::filesystem::file_size(folder.path() / "a" / "b" / name), 100u) << name;
  }
}

TEST(Snapshot, ReadsAWorldOrSaysThatItIsNone) {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> bytes = Encode(ExampleWorld());
  const auto good = folder.Write("good", std::string(bytes.begin(), bytes.end()));
  EXPECT_EQ(ReadWorld(good).uavs[3].id, 3);
  const auto cut = folder.Write("cut", std::string(bytes.begin(), bytes.end() - 9));
  EXPECT_THROW(ReadWorld(cut), ConfigError);
  EXPECT_THROW(ReadWorld(folder.path() / "none"), ConfigError);
}

}  // namespace
}  // namespace windhover
