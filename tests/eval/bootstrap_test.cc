#include "eval/bootstrap.h"

#include <cmath>

#include <gtest/gtest.h>

#include "common/random/random_stream.h"

namespace windhover {
namespace {

TEST(TimeBlocks, WorkedExample) {
  // 50 frames of 0.1 s are 5 s: two blocks of 2.5 s, not three that would be too short.
  const TimeBlocks blocks(1'000'000, 5'900'000, 0.1, 2);
  EXPECT_EQ(blocks.count(), 2);
  EXPECT_EQ(blocks.BlockOf(1'000'000), 0);
  EXPECT_EQ(blocks.BlockOf(3'400'000), 0);
  EXPECT_EQ(blocks.BlockOf(3'500'000), 1);
  EXPECT_EQ(blocks.BlockOf(5'900'000), 1);
}

TEST(TimeBlocks, AreNeverShorterThanAsked) {
  for (int n_frames = 1; n_frames <= 500; ++n_frames) {
    const TimeBlocks blocks(0, UtimeFromSeconds((n_frames - 1) / 30.0), 1 / 30.0, 2);
    // 2 µs: both the last frame's time and the period are rounded to 1 µs.
    if (blocks.count() > 1) {
      EXPECT_GE(n_frames / 30.0 / blocks.count(), 2 - 2e-6) << n_frames;
    }
    EXPECT_LT(n_frames / 30.0 / blocks.count(), 4) << n_frames;
  }
}

TEST(StudentT975, AgreesWithTheTable) {
  // Table of Student's t, 0.975 quantile. 1 %: what the header promises.
  EXPECT_NEAR(StudentT975(4), 2.776, 0.028);
  EXPECT_NEAR(StudentT975(9), 2.262, 0.002);
  EXPECT_NEAR(StudentT975(30), 2.042, 0.001);
}

TEST(BootstrapInterval95, OfEqualBlocksIsTheirMean) {
  const std::vector<BlockSum> blocks(10, {.sum = 6, .count = 3});
  const auto interval = BootstrapInterval95(blocks, 1);
  ASSERT_TRUE(interval);
  EXPECT_EQ((*interval)[0], 2);
  EXPECT_EQ((*interval)[1], 2);
}

TEST(BootstrapInterval95, TakesTwoBlocksWithTerms) {
  EXPECT_FALSE(BootstrapInterval95(std::vector<BlockSum>{{1, 1}}, 1));
  EXPECT_FALSE(BootstrapInterval95(std::vector<BlockSum>{{1, 1}, {0, 0}}, 1));
  EXPECT_TRUE(BootstrapInterval95(std::vector<BlockSum>{{1, 1}, {2, 1}}, 1));
}

TEST(BootstrapInterval95, IsTheSameForTheSameSeed) {
  const std::vector<BlockSum> blocks{{1, 1}, {2, 1}, {4, 1}, {8, 1}, {16, 1}};
  EXPECT_EQ(BootstrapInterval95(blocks, 7), BootstrapInterval95(blocks, 7));
  EXPECT_NE(BootstrapInterval95(blocks, 7), BootstrapInterval95(blocks, 8));
}

/// Share of 400 simulated flights of 20 s whose interval holds the true mean 0. Errors are a
/// slow drift (constant over `drift_s`) plus white noise; blocks are of 2 s or of one frame.
double Coverage(double drift_s, double block_s) {
  int n_covered = 0;
  constexpr int kFlights = 400;
  for (int flight = 0; flight < kFlights; ++flight) {
    RandomStream random(static_cast<std::uint64_t>(flight), "flight");
    const TimeBlocks of_flight(0, 19'900'000, 0.1, block_s);
    std::vector<BlockSum> sums(static_cast<std::size_t>(of_flight.count()));
    double drift = 0;
    for (int k = 0; k < 200; ++k) {
      if (k % static_cast<int>(drift_s * 10) == 0) drift = random.Normal();
      BlockSum& sum = sums[static_cast<std::size_t>(of_flight.BlockOf(k * 100'000))];
      sum.sum += drift + 0.3 * random.Normal();
      ++sum.count;
    }
    const auto interval = BootstrapInterval95(sums, static_cast<std::uint64_t>(flight));
    n_covered += (*interval)[0] <= 0 && 0 <= (*interval)[1];
  }
  return n_covered / static_cast<double>(kFlights);
}

// The share over 400 flights scatters by sqrt(0.95 * 0.05 / 400) = 0.011: 0.95 +- 0.035 is three
// standard deviations.
TEST(BootstrapInterval95, HoldsTheTruthIn95OfAHundredFlights) {
  EXPECT_NEAR(Coverage(/*drift_s=*/2, /*block_s=*/2), 0.95, 0.035);
}

TEST(BootstrapInterval95, WouldBeFarTooNarrowOverSingleFrames) {
  EXPECT_LT(Coverage(/*drift_s=*/2, /*block_s=*/0.1), 0.7);
}

}  // namespace
}  // namespace windhover
