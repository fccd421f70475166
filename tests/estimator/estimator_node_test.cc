#include "estimator/estimator_node.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/channels.h"
#include "lcmtypes/tick_done_t.hpp"

namespace windhover {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

stereo_box_t StereoBox(double left_x_px, double right_x_px) {
  stereo_box_t box{};
  box.left.x_px = left_x_px;
  box.right.x_px = right_x_px;
  box.left.y_px = box.right.y_px = 360;
  box.left.w_px = box.right.w_px = 50;
  box.left.h_px = box.right.h_px = 25;
  box.score = 1;
  return box;
}

AircraftConfig Config(Observe observe) {
  AircraftConfig config;
  config.observe = observe;
  for (const int id : {0, 1, 4}) {
    AircraftSelf aircraft;
    aircraft.id = id;
    aircraft.carries_rig = id != 1;
    config.aircraft.push_back(aircraft);
  }
  return config;
}

/// A node of aircraft 0 and 4 on an in-process bus, and a sim that feeds it.
class EstimatorNodeTest : public ::testing::Test {
 protected:
  void Start(Observe observe, ProcessShare share = {},
             const std::vector<std::string>& methods = {"size", "baseline"}) {
    AircraftConfig config = Config(observe);
    config.estimator.methods = methods;
    node_ = std::make_unique<EstimatorNode>(config, share, client_);
    for (const int id : {0, 1, 4}) {
      bus_.Subscribe<range_t>(channel::Range(id),
                              [this](const range_t& range) { ranges_.push_back(range); });
    }
    bus_.Subscribe<tick_done_t>(channel::kTickDone,
                                [this](const tick_done_t& done) { done_.push_back(done); });
  }

  void PublishTick(int k, std::int8_t phase = tick_t::PHASE_RUN) {
    tick_t tick{};
    tick.utime = k * 100'000;
    tick.tick = k;
    tick.run_id = 5;
    tick.phase = phase;
    bus_.Publish(channel::kTick, tick);
    for (const int id : {0, 4}) {
      nav_state_t nav{};
      nav.utime = tick.utime;
      nav.id = id;
      nav.qw = 1;
      bus_.Publish(channel::NavState(id), nav);
    }
  }

  void PublishBoxes(int k, int id, std::vector<stereo_box_t> boxes) {
    detection_t detections{};
    detections.utime = k * 100'000;
    detections.observer_id = id;
    detections.n_boxes = static_cast<int>(boxes.size());
    detections.boxes = std::move(boxes);
    bus_.Publish(channel::Detection(id), detections);
  }

  void PublishFrame(int k, int id, int width, int height) {
    stereo_frame_t frame{};
    frame.utime = k * 100'000;
    for (image_t* image : {&frame.left, &frame.right}) {
      image->width = width;
      image->height = height;
      image->row_stride = 3 * width;
      image->pixelformat = image_t::PIXEL_FORMAT_RGB;
      image->data.assign(static_cast<std::size_t>(3 * width * height), 128);
      image->size = static_cast<int>(image->data.size());
    }
    bus_.Publish(channel::Stereo(id), frame);
  }

  void Pump() {
    while (bus_.Handle(0)) continue;
  }

  Bus bus_{"memq://"};
  TickClient client_{bus_, "estimator-0", 5};
  std::unique_ptr<EstimatorNode> node_;
  std::vector<range_t> ranges_;
  std::vector<tick_done_t> done_;
};

TEST_F(EstimatorNodeTest, AnswersEveryBoxWithEveryMethodInOrder) {
  Start(Observe::kAnnotated);
  PublishTick(1);
  PublishBoxes(1, 0, {StereoBox(700, 600), StereoBox(300, 170)});
  PublishBoxes(1, 4, {});
  Pump();
  ASSERT_EQ(ranges_.size(), 2u);
  EXPECT_EQ(ranges_[0].observer_id, 0);
  EXPECT_EQ(ranges_[0].utime, 100'000);
  ASSERT_EQ(ranges_[0].estimates.size(), 4u);
  std::vector<std::pair<int, std::string>> order;
  for (const auto& e : ranges_[0].estimates) order.emplace_back(e.detection_index, e.method);
  EXPECT_THAT(order, ElementsAre(std::pair(0, "size"), std::pair(0, "baseline"),
                                 std::pair(1, "size"), std::pair(1, "baseline")));
  // f · baseline / disparity, on the axis within 0.1 rad: range is depth within 1 %.
  EXPECT_NEAR(ranges_[0].estimates[1].range_m, 12e3 / 3.7325 * 0.406 / 100, 0.14);
  EXPECT_EQ(ranges_[1].observer_id, 4);
  EXPECT_EQ(ranges_[1].n_estimates, 0);
  ASSERT_EQ(done_.size(), 1u);
  EXPECT_EQ(done_[0].n_channels, 2);
}

TEST_F(EstimatorNodeTest, SaysWhenABoxHasNoDistance) {
  Start(Observe::kAnnotated);
  PublishTick(1);
  PublishBoxes(1, 0, {StereoBox(600, 600)});
  PublishBoxes(1, 4, {});
  Pump();
  ASSERT_EQ(ranges_.at(0).estimates.size(), 2u);
  EXPECT_EQ(ranges_[0].estimates[0].status, range_estimate_t::STATUS_OK);
  EXPECT_EQ(ranges_[0].estimates[1].status, range_estimate_t::STATUS_NO_ESTIMATE);
}

TEST_F(EstimatorNodeTest, ServesItsShareOnly) {
  Start(Observe::kAnnotated, {.index = 0, .count = 2});  // Positions 0 and 2: aircraft 0 and 4.
  PublishTick(1);
  PublishBoxes(1, 0, {});
  Pump();
  EXPECT_TRUE(ranges_.empty());
  PublishBoxes(1, 4, {});
  Pump();
  EXPECT_EQ(ranges_.size(), 2u);
}

TEST_F(EstimatorNodeTest, TracksKeepTheirNumbers) {
  Start(Observe::kAnnotated);
  for (int k = 1; k <= 2; ++k) {
    PublishTick(k);
    // The second frame lists the targets the other way round.
    PublishBoxes(k, 0,
                 k == 1 ? std::vector{StereoBox(700, 600), StereoBox(100, 40)}
                        : std::vector{StereoBox(102, 42), StereoBox(704, 603)});
    PublishBoxes(k, 4, {});
    Pump();
  }
  EXPECT_EQ(ranges_[0].estimates[0].track_id, 0);
  EXPECT_EQ(ranges_[0].estimates[2].track_id, 1);
  EXPECT_EQ(ranges_[2].estimates[0].track_id, 1);
  EXPECT_EQ(ranges_[2].estimates[2].track_id, 0);
}

TEST_F(EstimatorNodeTest, TheRehearsalLeavesNoTrace) {
  Start(Observe::kAnnotated);
  PublishTick(0, tick_t::PHASE_REHEARSAL);
  PublishBoxes(0, 0, {StereoBox(100, 40)});
  PublishBoxes(0, 4, {});
  Pump();
  ASSERT_EQ(ranges_.size(), 2u);
  PublishTick(1);
  PublishBoxes(1, 0, {StereoBox(700, 600), StereoBox(100, 40)});
  PublishBoxes(1, 4, {});
  Pump();
  EXPECT_EQ(ranges_.at(2).estimates[0].track_id, 0);
  EXPECT_EQ(ranges_[2].estimates[2].track_id, 1) << "the rehearsed target must not have number 0";
}

TEST_F(EstimatorNodeTest, EachRigLearnsByItself) {
  Start(Observe::kAnnotated, {}, {"selfcal", "fusion"});
  PublishTick(0, tick_t::PHASE_REHEARSAL);  // Must teach nobody anything.
  PublishBoxes(0, 0, {StereoBox(900, 600)});
  PublishBoxes(0, 4, {StereoBox(700, 600)});
  Pump();
  for (int k = 1; k <= 20; ++k) {
    PublishTick(k);
    PublishBoxes(k, 0, {StereoBox(700, 600)});
    PublishBoxes(k, 4, k == 1 ? std::vector{StereoBox(700, 600)} : std::vector<stereo_box_t>{});
    Pump();
  }
  ASSERT_EQ(ranges_.size(), 42u);
  const range_estimate_t& first = ranges_[2].estimates[0];
  ASSERT_EQ(first.method, "selfcal");
  EXPECT_EQ(first.status, range_estimate_t::STATUS_OK);
  EXPECT_EQ(first.range_m, ranges_[3].estimates[0].range_m) << "aircraft 4 saw the same, once";
  EXPECT_EQ(ranges_[2].estimates[1].range_m, ranges_[40].estimates[1].range_m) << "fusion";
  EXPECT_LT(ranges_[40].estimates[0].range_sigma_m, 0.9 * first.range_sigma_m);
}

TEST_F(EstimatorNodeTest, DetectsInImages) {
  Start(Observe::kImage);
  std::vector<detection_t> detections;
  bus_.Subscribe<detection_t>(channel::Detection(0),
                              [&](const detection_t& d) { detections.push_back(d); });
  PublishTick(1);
  PublishFrame(1, 0, 320, 180);
  PublishFrame(1, 4, 320, 180);
  Pump();
  ASSERT_EQ(detections.size(), 1u);
  EXPECT_EQ(detections[0].utime, 100'000);
  EXPECT_EQ(detections[0].detector, "classical");
  EXPECT_EQ(detections[0].n_boxes, 0) << "a grey wall";
  EXPECT_EQ(ranges_.size(), 2u);
}

}  // namespace
}  // namespace windhover
