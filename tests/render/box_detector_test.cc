#include "render/box_detector.h"

#include <cmath>

#include <gtest/gtest.h>

#include "common/geometry/rotation.h"
#include "render/outline.h"
#include "render/scene_geometry.h"
#include "tests/render/render_examples.h"

namespace windhover {
namespace {

target_view_t ViewAt(double x_px, double y_px, double w_px, double h_px) {
  target_view_t view{};
  view.in_front = 1;
  view.full.x_px = view.centre_px[0] = x_px;
  view.full.y_px = view.centre_px[1] = y_px;
  view.full.w_px = w_px;
  view.full.h_px = h_px;
  view.visible = view.full;
  return view;
}

annotation_t Annotation(std::vector<target_annotation_t> targets) {
  annotation_t annotation{};
  annotation.utime = 7;
  annotation.n_targets = static_cast<int>(targets.size());
  annotation.targets = std::move(targets);
  return annotation;
}

target_annotation_t Target(int id, double left_x_px, double right_x_px) {
  target_annotation_t target{};
  target.target_id = id;
  target.left = ViewAt(left_x_px, 300, 100, 50);
  target.right = ViewAt(right_x_px, 300, 100, 50);
  return target;
}

GeometricConfig Noise(double sigma_px, double sigma_relative, double correlation,
                      double miss_rate) {
  return {.sigma_px = sigma_px,
          .sigma_relative = sigma_relative,
          .correlation = correlation,
          .miss_rate = miss_rate};
}

TEST(DetectVisible, OrdersByVisibleShareThenFromTheLeft) {
  std::vector<target_annotation_t> targets = {Target(1, 500, 480), Target(2, 900, 880),
                                              Target(3, 100, 80), Target(4, 300, 280)};
  targets[0].right.occlusion = 0.5;
  targets[3].left.visible = {};  // Hidden from the left camera.
  const detection_t detection = DetectVisible(Annotation(targets));
  ASSERT_EQ(detection.n_boxes, 3);
  EXPECT_EQ(detection.utime, 7);
  EXPECT_EQ(detection.boxes[0].left.x_px, 100);
  EXPECT_EQ(detection.boxes[1].left.x_px, 900);
  EXPECT_EQ(detection.boxes[2].left.x_px, 500);
  EXPECT_EQ(detection.boxes[2].score, 0.5);
}

TEST(DetectGeometric, IsTheFullBoxWithoutNoise) {
  const annotation_t annotation = Annotation({Target(1, 500, 480)});
  const detection_t detection = DetectGeometric(annotation, Noise(0, 0, 0.5, 0), 1, 4, 1280, 720);
  ASSERT_EQ(detection.n_boxes, 1);
  EXPECT_EQ(detection.boxes[0].left.x_px, 500);
  EXPECT_EQ(detection.boxes[0].right.x_px, 480);
  EXPECT_EQ(detection.boxes[0].right.w_px, 100);
}

TEST(DetectGeometric, SeesOnlyWhatBothCamerasSee) {
  const annotation_t annotation = Annotation({Target(1, 10, -20), Target(2, 1300, 1270)});
  EXPECT_EQ(DetectGeometric(annotation, Noise(1, 0, 0, 0), 1, 0, 1280, 720).n_boxes, 0);
}

// 20,000 ticks know a variance to 1 % and a correlation to 0.007; limits are four times that.
TEST(DetectGeometric, HasTheNoiseOfItsConfiguration) {
  constexpr int kTicks = 20'000;
  const annotation_t annotation = Annotation({Target(1, 500, 480)});
  for (const double correlation : {-0.6, 0.0, 0.5, 1.0}) {
    double left2 = 0, right2 = 0, both = 0, width2 = 0;
    for (int tick = 0; tick < kTicks; ++tick) {
      const detection_t detection =
          DetectGeometric(annotation, Noise(3, 0.04, correlation, 0), 9, tick, 1280, 720);
      const double left = detection.boxes[0].left.x_px - 500;
      const double right = detection.boxes[0].right.x_px - 480;
      left2 += left * left / kTicks;
      right2 += right * right / kTicks;
      both += left * right / kTicks;
      width2 += std::pow(detection.boxes[0].left.w_px - 100, 2) / kTicks;
    }
    EXPECT_NEAR(left2, 25, 1);  // 3² + (0.04 · 100)²
    EXPECT_NEAR(right2, 25, 1);
    EXPECT_NEAR(width2, 25, 1);
    EXPECT_NEAR(both / std::sqrt(left2 * right2), correlation, 0.028);
  }
}

// A box of 100 px with 1 - correlation = 0.1 (1 + (100 / 50)²) in x; beyond ten times that none.
TEST(DetectGeometric, SeesOtherSidesOfNearTargets) {
  GeometricConfig noise = Noise(3, 0, 0.9, 0);
  noise.correlation_width_px = 50;
  EXPECT_DOUBLE_EQ(CorrelationOfX(noise, 0), 0.9);
  EXPECT_DOUBLE_EQ(CorrelationOfX(noise, 100), 0.5);
  EXPECT_DOUBLE_EQ(CorrelationOfX(noise, 200), 0);
  noise.correlation = -0.9;
  EXPECT_DOUBLE_EQ(CorrelationOfX(noise, 100), -0.5);
  noise.correlation = 0.9;
  constexpr int kTicks = 20'000;
  double x2 = 0, y2 = 0;
  for (int tick = 0; tick < kTicks; ++tick) {
    const auto boxes =
        DetectGeometric(Annotation({Target(1, 500, 480)}), noise, 9, tick, 1280, 720).boxes;
    x2 += std::pow(boxes[0].left.x_px - boxes[0].right.x_px - 20, 2) / kTicks;
    y2 += std::pow(boxes[0].left.y_px - boxes[0].right.y_px, 2) / kTicks;
  }
  EXPECT_NEAR(x2, 9 * 2 * 0.5, 0.04 * 9);  // 20,000 ticks know a variance to 1 %.
  EXPECT_NEAR(y2, 9 * 2 * 0.1, 0.04 * 1.8);
}

TEST(DetectGeometric, MissesItsShare) {
  const annotation_t annotation = Annotation({Target(1, 500, 480)});
  int seen = 0;
  for (int tick = 0; tick < 10'000; ++tick) {
    seen += DetectGeometric(annotation, Noise(1, 0, 0, 0.3), 9, tick, 1280, 720).n_boxes;
  }
  EXPECT_NEAR(seen, 7000, 4 * std::sqrt(10'000 * 0.3 * 0.7));
}

TEST(DetectGeometric, NoiseOfOneTargetDoesNotDependOnOthers) {
  const GeometricConfig noise = Noise(1, 0.01, 0.5, 0);
  const detection_t alone =
      DetectGeometric(Annotation({Target(2, 600, 580)}), noise, 1, 8, 1280, 720);
  const detection_t together = DetectGeometric(
      Annotation({Target(1, 100, 80), Target(2, 600, 580)}), noise, 1, 8, 1280, 720);
  EXPECT_EQ(alone.boxes[0].left.x_px, together.boxes[1].left.x_px);
}

TEST(DetectTruth, TriangulatesExactlyWithTheCalibratedRig) {
  const Scenario scenario = ExampleScenario(Observe::kTruth);  // Misaligned and distorted.
  const SceneGeometry geometry(scenario, {0});
  const annotation_t annotation = geometry.Annotate(ExampleWorld(), 0);
  const StereoRig rig = scenario.rig.calibrated.ToStereoRig();
  const detection_t detection = DetectTruth(annotation, rig);
  ASSERT_EQ(detection.n_boxes, 2);  // 2 is beside the observer.
  for (const stereo_box_t& box : detection.boxes) {
    const auto point =
        Triangulate(rig, {box.left.x_px, box.left.y_px}, {box.right.x_px, box.right.y_px}, 1);
    ASSERT_TRUE(point);
    double nearest = 1e9;
    for (const target_annotation_t& target : annotation.targets) {
      nearest = std::min(nearest, (point->p_RT_m - Eigen::Vector3d(target.p_RT_m)).norm());
    }
    EXPECT_LT(nearest, 1e-6);  // Unproject is exact to 1e-9 px: 1e-9 Z² / (f b) = 1e-9 m and more.
  }
}

// Eight points at a time, the bits of one after the other: through lenses with and without
// tangential terms, also where points lie behind the camera or where the lens folds.
TEST(Outline, IsTheBoxAroundEveryPoint) {
  std::vector<Eigen::Vector3d> points_B_m;
  for (int i = 0; i < 83; ++i) {
    points_B_m.emplace_back(0.4 * std::sin(1.1 * i), 0.5 * std::cos(2.3 * i), 0.1 * std::sin(i));
  }
  const Outline outline(points_B_m);
  for (const double k1 : {0.0, -0.1, 0.3}) {
    for (const double p1 : {0.0, 1e-3, 0.1}) {
      const PinholeRadtan camera{.fx_px = 3215,
                                 .fy_px = 3210,
                                 .cx_px = 639.5,
                                 .cy_px = 350,
                                 .k1 = k1,
                                 .p1 = p1,
                                 .p2 = -p1};
      for (const double depth_m : {20.0, 1.0, 0.45}) {
        Eigen::Isometry3d X_CB = Eigen::Isometry3d::Identity();
        X_CB.linear() = RotationFromVector({0.3, depth_m, -0.7});
        X_CB.translation() << 0.1 * depth_m, -0.02 * depth_m, depth_m;
        Eigen::AlignedBox2d expected;
        for (const Eigen::Vector3d& p_B_m : points_B_m) {
          if (const auto q_px = camera.Project(X_CB * p_B_m)) expected.extend(*q_px);
        }
        for (const auto isa :
             {InstructionSet::kSse2, InstructionSet::kAvx2, InstructionSet::kAvx512}) {
          if (isa > WidestInstructionSet()) continue;
          const Eigen::AlignedBox2d box = outline.BoxThrough(camera, X_CB, isa);
          EXPECT_EQ(box.min(), expected.min()) << k1 << ' ' << p1 << ' ' << depth_m;
          EXPECT_EQ(box.max(), expected.max()) << k1 << ' ' << p1 << ' ' << depth_m;
        }
      }
    }
  }
  EXPECT_TRUE(
      Outline().BoxThrough(PinholeRadtan{100, 100, 0, 0}, Eigen::Isometry3d::Identity()).isEmpty());
}

}  // namespace
}  // namespace windhover
