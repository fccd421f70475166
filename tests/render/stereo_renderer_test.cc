#include "render/stereo_renderer.h"

#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "common/image/srgb.h"
#include "tests/render/render_examples.h"

namespace windhover {
namespace {

std::vector<RenderedPair> Render(const Scenario& scenario, const std::vector<int>& observers,
                                 int threads, const world_truth_t& world, int tick = 3) {
  return StereoRenderer(scenario, observers, threads).Render(world, tick);
}

TEST(StereoRenderer, GivesTheSameBitsOnAnyNumberOfThreadsAndProcesses) {
  const Scenario scenario = ExampleScenario(Observe::kImage);
  const world_truth_t world = ExampleWorld();
  const auto together = Render(scenario, {0, 2}, 1, world);
  const auto threaded = Render(scenario, {0, 2}, 3, world);
  const auto first = Render(scenario, {0}, 2, world), second = Render(scenario, {2}, 2, world);
  ASSERT_EQ(together.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const RenderedPair& alone = (i == 0 ? first : second)[0];
    EXPECT_EQ(together[i].left.pixels, threaded[i].left.pixels);
    EXPECT_EQ(together[i].right.pixels, threaded[i].right.pixels);
    EXPECT_EQ(together[i].left.pixels, alone.left.pixels);
    EXPECT_EQ(together[i].right.pixels, alone.right.pixels);
  }
}

TEST(StereoRenderer, DoesNotRememberEarlierFrames) {
  const Scenario scenario = ExampleScenario(Observe::kImage);
  world_truth_t elsewhere = ExampleWorld();
  elsewhere.uavs[0] = TruthAt(0, {1, 2, 9}, 35);
  StereoRenderer renderer(scenario, {0}, 1);
  renderer.Render(elsewhere, 2);
  EXPECT_EQ(renderer.Render(ExampleWorld(), 3)[0].left.pixels,
            Render(scenario, {0}, 1, ExampleWorld())[0].left.pixels);
}

TEST(StereoRenderer, NoiseDiffersBetweenTicks) {
  const Scenario scenario = ExampleScenario(Observe::kImage);
  StereoRenderer renderer(scenario, {0}, 1);
  EXPECT_NE(renderer.Render(ExampleWorld(), 3)[0].left.pixels,
            renderer.Render(ExampleWorld(), 4)[0].left.pixels);
}

// Pixels in which two images differ, as edges of a box.
image_box_t BoxOfDifference(const RgbImage& a, const RgbImage& b) {
  int x0 = a.width_px, x1 = -1, y0 = a.height_px, y1 = -1;
  for (int y = 0; y < a.height_px; ++y) {
    for (int x = 0; x < a.width_px; ++x) {
      bool differs = false;
      for (int c = 0; c < 3; ++c) differs |= a.Row(y)[3 * x + c] != b.Row(y)[3 * x + c];
      if (!differs) continue;
      x0 = std::min(x0, x);
      x1 = std::max(x1, x);
      y0 = std::min(y0, y);
      y1 = std::max(y1, y);
    }
  }
  image_box_t box{};
  box.x_px = (x0 + x1) / 2.0;
  box.y_px = (y0 + y1) / 2.0;
  box.w_px = x1 - x0 + 1;
  box.h_px = y1 - y0 + 1;
  return box;
}

void ExpectEdgesNear(const image_box_t& a, const image_box_t& b, double tolerance_px) {
  EXPECT_NEAR(a.x_px - a.w_px / 2, b.x_px - b.w_px / 2, tolerance_px);
  EXPECT_NEAR(a.x_px + a.w_px / 2, b.x_px + b.w_px / 2, tolerance_px);
  EXPECT_NEAR(a.y_px - a.h_px / 2, b.y_px - b.h_px / 2, tolerance_px);
  EXPECT_NEAR(a.y_px + a.h_px / 2, b.y_px + b.h_px / 2, tolerance_px);
}

// A pixel counts as changed when any of it is covered, so an edge may be off by almost one.
TEST(StereoRenderer, VisibleBoxHoldsExactlyTheChangedPixels) {
  Scenario scenario = ExampleScenario(Observe::kImage);
  scenario.sensor.noise = false;
  scenario.aircraft.resize(2);
  for (const double distance_m : {5.0, 10.0, 20.0, 40.0}) {
    world_truth_t world = ExampleWorld();
    world.uavs = {TruthAt(0, {0, 0, 10}), TruthAt(1, {distance_m, 0.1, 10.05}, 25)};
    world.n_uavs = 2;
    world_truth_t empty = world;
    empty.uavs[1] = TruthAt(1, {-50, 0, 10});
    StereoRenderer renderer(scenario, {0}, 1);
    const RenderedPair with = std::move(renderer.Render(world, 0)[0]);
    const RenderedPair without = std::move(renderer.Render(empty, 0)[0]);
    const target_annotation_t& target = with.annotation.targets[0];
    ExpectEdgesNear(BoxOfDifference(with.left, without.left), target.left.visible, 1);
    ExpectEdgesNear(BoxOfDifference(with.right, without.right), target.right.visible, 1);
    ExpectEdgesNear(target.left.full, target.left.visible, 0.5);
    ExpectEdgesNear(target.right.full, target.right.visible, 0.5);
    EXPECT_EQ(target.left.occlusion, 0);
    EXPECT_EQ(without.annotation.targets[0].left.in_front, 0);
  }
}

TEST(StereoRenderer, AnnotatesTruth) {
  const Scenario scenario = ExampleScenario(Observe::kImage);
  const annotation_t annotation = Render(scenario, {0}, 1, ExampleWorld())[0].annotation;
  ASSERT_EQ(annotation.n_targets, 3);
  EXPECT_EQ(annotation.observer_id, 0);
  EXPECT_EQ(annotation.utime, 300'000);
  const target_annotation_t& ahead = annotation.targets[0];
  EXPECT_EQ(ahead.target_id, 1);
  // The rig is 0.15 m ahead of the aircraft's centre; R is right-down-forward.
  EXPECT_NEAR(ahead.p_RT_m[0], -0.4, 1e-12);
  EXPECT_NEAR(ahead.p_RT_m[1], -0.1, 1e-12);
  EXPECT_NEAR(ahead.p_RT_m[2], 11.85, 1e-12);
  EXPECT_NEAR(ahead.range_m, std::sqrt(0.16 + 0.01 + 11.85 * 11.85), 1e-12);
  EXPECT_EQ(ahead.depth_m, ahead.p_RT_m[2]);
  const target_annotation_t& behind = annotation.targets[2];
  EXPECT_EQ(behind.target_id, 3);
  EXPECT_GT(behind.left.occlusion + behind.right.occlusion, 0.02);
  EXPECT_LT(behind.left.occlusion, 1);
  EXPECT_EQ(ahead.left.occlusion, 0);
}

TEST(StereoRenderer, TruncatesAtTheBorder) {
  Scenario scenario = ExampleScenario(Observe::kImage);
  scenario.aircraft.resize(2);
  world_truth_t world = ExampleWorld();
  // 320 px / 1607.5 px half the field at 10 m: the centre is at the left border.
  world.uavs = {TruthAt(0, {0, 0, 10}), TruthAt(1, {10.15, 9.9 * 0.2, 10})};
  world.n_uavs = 2;
  const annotation_t annotation = Render(scenario, {0}, 1, world)[0].annotation;
  const target_view_t& view = annotation.targets[0].left;
  EXPECT_GT(view.truncation, 0.1);
  EXPECT_LT(view.truncation, 0.95);
  EXPECT_NEAR(view.visible.x_px - view.visible.w_px / 2, -0.5, 1e-9);
  EXPECT_LT(view.full.x_px - view.full.w_px / 2, -0.5);
}

TEST(StereoRenderer, BlursByMotion) {
  Scenario scenario = ExampleScenario(Observe::kImage);
  scenario.sensor.noise = false;
  scenario.exposure.duration_ms = 10;
  scenario.aircraft.resize(2);
  world_truth_t world = ExampleWorld();
  world.uavs.resize(2);
  world.n_uavs = 2;
  const RenderedPair sharp = std::move(Render(scenario, {0}, 2, world)[0]);
  world.uavs[0].w_WB_B_radps[2] = 0.5;  // 8 px of smear.
  const RenderedPair blurred = std::move(Render(scenario, {0}, 2, world)[0]);
  const auto roughness = [](const RgbImage& image) {
    double sum = 0;
    for (int x = 1; x < image.width_px; ++x) {
      sum += std::abs(image.Row(180)[3 * x] - image.Row(180)[3 * x - 3]);
    }
    return sum;
  };
  EXPECT_LT(roughness(blurred.left), 0.8 * roughness(sharp.left));
  EXPECT_EQ(blurred.annotation.targets[0].left.full.x_px,
            sharp.annotation.targets[0].left.full.x_px);
}

TEST(StereoRenderer, RefusesAForeignWorld) {
  world_truth_t world = ExampleWorld();
  world.uavs.pop_back();
  world.n_uavs = 3;
  EXPECT_THROW(Render(ExampleScenario(Observe::kImage), {0}, 1, world), std::runtime_error);
}

// Linear light of the darkest pixel in the box of the target 12 m ahead.
double Darkest(const RenderedPair& pair) {
  const image_box_t& box = pair.annotation.targets[0].left.visible;
  double darkest = 255;
  for (int y = static_cast<int>(box.y_px - box.h_px / 2); y <= box.y_px + box.h_px / 2; ++y) {
    for (int x = static_cast<int>(box.x_px - box.w_px / 2); x <= box.x_px + box.w_px / 2; ++x) {
      darkest = std::min<double>(darkest, pair.left.Row(y)[3 * x + 1]);
    }
  }
  return LinearFromSrgb(darkest / 255);
}

// Fog of 50 m leaves 0.02^(12/50) = 39 % of what is 12 m away; the rest is air.
TEST(StereoRenderer, VeilsAircraftByTheirDistance) {
  Scenario scenario = ExampleScenario(Observe::kImage);
  scenario.sensor.noise = false;
  scenario.environment.visibility_m = 1e6;
  const double clear = Darkest(Render(scenario, {0}, 2, ExampleWorld())[0]);
  scenario.environment.visibility_m = 50;
  const auto environment = MakeEnvironment(scenario.environment);
  const double air = environment->AirLight({1, 0, 0}).y(), left = std::pow(0.02, 12.0 / 50);
  EXPECT_LT(clear, 0.1);
  // What fog does to the light on the aircraft is at most to double it.
  const double fogged = Darkest(Render(scenario, {0}, 2, ExampleWorld())[0]);
  EXPECT_GT(fogged, (1 - left) * air - 0.02);
  EXPECT_LT(fogged, (1 - left) * air + 2 * left * clear + 0.02);
}

}  // namespace
}  // namespace windhover
