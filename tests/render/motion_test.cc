#include "render/motion.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

namespace windhover {
namespace {

double Mean(const std::vector<ExposureNode>& nodes, const std::function<double(double)>& f) {
  double mean = 0;
  for (const ExposureNode& node : nodes) mean += node.share / 65536.0 * f(node.offset_s);
  return mean;
}

// The mean of t^k over [-T/2, T/2] is (T/2)^k / (k + 1) for even k and 0 for odd k; n nodes are
// exact up to k = 2 n - 1. Shares are rounded to 65536ths: 5 of them err by 4e-5 at most.
TEST(BackgroundNodes, IntegratePolynomialsOfTime) {
  constexpr double kDuration_s = 2;  // T/2 = 1, so that every power counts alike.
  for (const double motion_px : {0.5, 2.0, 4.0, 7.0, 20.0}) {
    const auto nodes = BackgroundNodes(motion_px, kDuration_s, 16);
    for (std::size_t k = 0; k <= 2 * nodes.size() - 1; ++k) {
      const double expected = k % 2 == 0 ? 1.0 / static_cast<double>(k + 1) : 0;
      const double mean =
          Mean(nodes, [k](double t) { return std::pow(t, static_cast<double>(k)); });
      EXPECT_NEAR(mean, expected, 4e-5) << nodes.size() << " nodes, power " << k;
    }
  }
}

// A uniform motion of L px turns a wave of f cycles a pixel into sinc(L f) of it.
TEST(BackgroundNodes, BlurAWaveLikeTheTrueMotion) {
  for (double motion_px = 0.1; motion_px < 9; motion_px += 0.1) {
    const auto nodes = BackgroundNodes(motion_px, 1, 16);
    for (double cycles = 0.01; cycles <= 0.25; cycles += 0.01) {
      const double phase = EIGEN_PI * motion_px * cycles;
      const double blurred =
          Mean(nodes, [=](double t) { return std::cos(2 * EIGEN_PI * cycles * motion_px * t); });
      EXPECT_NEAR(blurred, std::sin(phase) / phase, 0.1) << motion_px << " px, " << cycles;
    }
  }
}

TEST(BackgroundNodes, AreNoMoreThanAllowed) {
  EXPECT_EQ(BackgroundNodes(20, 1, 16).size(), 5u);
  EXPECT_EQ(BackgroundNodes(20, 1, 3).size(), 3u);
  EXPECT_EQ(BackgroundNodes(20, 1, 1).size(), 1u);
}

// What flies past does not blur what is behind it: a pair of images, one with and one without the
// target, has the same surroundings.
TEST(PlanExposure, TakesTheSurroundingsBlurFromTheCamerasAlone) {
  Scenario scenario;
  const RigMotion still(scenario.rig.calibrated.ToStereoRig(), {}, {}, {}, 1, "uav0");
  world_truth_t world{};
  world.uavs.resize(2);
  world.uavs[0].qw = world.uavs[1].qw = 1;
  world.uavs[1].p_WB_m[0] = 10;
  const auto plan = [&] { return PlanExposure({.max_blur_px = 1}, 3e-3, world, 0, still, 3215); };
  EXPECT_EQ(plan().background.size(), 1u);
  EXPECT_EQ(plan().offsets_s.size(), 1u);
  // 5 m/s at 10 m for 3 ms of 3215 px: 4.8 px, in an odd number of parts.
  world.uavs[1].v_WB_mps[1] = 5;
  EXPECT_EQ(plan().background.size(), 1u);
  EXPECT_EQ(plan().offsets_s.size(), 5u);
  // The cameras turn by half a radian a second: 4.8 px, too, of which three nodes are enough.
  world.uavs[0].w_WB_B_radps[2] = 0.5;
  EXPECT_EQ(plan().background.size(), 3u);
}

// 50 turns a second for 2 ms: a tenth of a turn.
TEST(TurningOf, CarriesRotorsOnToTheExposure) {
  uav_truth_t truth{};
  truth.rotor_phase_rev[2] = 0.1;
  truth.rotor_rate_hz[2] = 50;
  const RotorTurning turning = TurningOf(truth, 2e-3, 1e-3);
  EXPECT_NEAR(turning.phase_rev[2], 0.2, 1e-12);
  EXPECT_EQ(turning.rate_hz[2], 50);
  EXPECT_EQ(turning.duration_s, 1e-3);
}

}  // namespace
}  // namespace windhover
