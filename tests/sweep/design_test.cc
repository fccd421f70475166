#include "sweep/design.h"

#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sweep/sobol_sequence.h"

namespace windhover {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;

Factor Words() { return Factor({.key = "flex.section", .values = {"tube", "plate"}}); }
Factor Range(const std::string& key, double min, double max, int levels = 3) {
  return Factor({.key = key, .min = min, .max = max, .levels = levels});
}

TEST(Factor, LevelsOfARangeHaveItsEnds) {
  EXPECT_THAT(Range("a", 8, 25, 3).Levels(), ElementsAre("8", "16.5", "25"));
  const Factor log({.key = "a", .min = 0.001, .max = 0.1, .scale = FactorScale::kLog, .levels = 3});
  EXPECT_EQ(log.Levels().front(), "0.001");
  EXPECT_EQ(log.Levels().back(), "0.1");
  EXPECT_NEAR(*NumberOf(log.Levels()[1]), 0.01, 1e-15);
}

// Φ⁻¹(0.975) = 1.95996.
TEST(Factor, NormalValuesAreItsQuantiles) {
  const Factor normal({.key = "a", .mean = 10, .sigma = 2});
  EXPECT_NEAR(*NumberOf(normal.At(0.5)), 10, 1e-9);
  EXPECT_NEAR(*NumberOf(normal.At(0.975)), 10 + 2 * 1.959964, 1e-5);
  const Factor log({.key = "a", .mean = 10, .sigma = 0.5, .scale = FactorScale::kLog});
  EXPECT_NEAR(*NumberOf(log.At(0.975)), 10 * std::exp(0.5 * 1.959964), 1e-4);
}

// Between −1 σ and +1 σ a quarter of what is left lies below Φ⁻¹(0.1587 + 0.25 · 0.6827) = −0.442.
TEST(Factor, BoundsCutANormalDistributionOff) {
  const Factor cut({.key = "a", .min = 9, .max = 11, .mean = 10, .sigma = 1});
  EXPECT_NEAR(*NumberOf(cut.At(0.25)), 10 - 0.442, 1e-3);
  for (double u = 0; u < 1; u += 0.01) {
    EXPECT_GE(*NumberOf(cut.At(u)), 9);
    EXPECT_LE(*NumberOf(cut.At(u)), 11);
  }
}

TEST(Factor, ListedValuesAreEachAsLikely) {
  EXPECT_EQ(Words().At(0.49), "tube");
  EXPECT_EQ(Words().At(0.5), "plate");
  EXPECT_FALSE(Words().is_number());
  EXPECT_TRUE(Factor({.key = "a", .values = {"8", "12.5"}}).is_number());
}

// The first points of the sequence in three dimensions, as in Joe and Kuo's own example.
TEST(SobolSequence, BeginsAsPublished) {
  const SobolSequence sequence(3);
  const double expected[][3] = {
      {0, 0, 0}, {0.5, 0.5, 0.5}, {0.75, 0.25, 0.25}, {0.25, 0.75, 0.75}, {0.375, 0.375, 0.625}};
  for (std::uint32_t n = 0; n < 5; ++n) {
    const auto point = sequence.Point(n);
    for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(point[d], expected[n][d], 1e-9) << n;
  }
}

// 2^k points have one in each of 2^k slices of every axis; of every pair of axes they have the same
// number in each quarter.
TEST(SobolSequence, FillsEveryAxisEvenly) {
  constexpr int kPoints = 64, kAxes = SobolSequence::kMaxDimensions;
  const SobolSequence sequence(kAxes);
  std::vector<std::set<int>> slices(kAxes);
  std::vector<std::vector<int>> quarters(kAxes, std::vector<int>(4));
  for (std::uint32_t n = 0; n < kPoints; ++n) {
    const auto point = sequence.Point(n);
    for (std::size_t d = 0; d < kAxes; ++d) {
      slices[d].insert(static_cast<int>(point[d] * kPoints));
      const double other = point[(d + 1) % kAxes];
      ++quarters[d][(point[d] < 0.5 ? 0 : 1) + (other < 0.5 ? 0 : 2)];
    }
  }
  for (std::size_t d = 0; d < kAxes; ++d) {
    EXPECT_EQ(slices[d].size(), static_cast<std::size_t>(kPoints)) << d;
    EXPECT_THAT(quarters[d], testing::Each(kPoints / 4)) << d;
  }
}

TEST(Design, GridHasEveryCombination) {
  const std::vector<Factor> factors = {Words(), Range("a", 0, 1, 2)};
  EXPECT_THAT(DesignPoints({.type = DesignType::kGrid}, factors, {}),
              ElementsAre(DesignPoint{"tube", "0"}, DesignPoint{"tube", "1"},
                          DesignPoint{"plate", "0"}, DesignPoint{"plate", "1"}));
  EXPECT_EQ(CountDesignPoints({.type = DesignType::kGrid}, factors), 4);
  EXPECT_EQ(DesignPoints({.type = DesignType::kGrid}, {}, {}).size(), 1u) << "the base alone";
}

TEST(Design, OneAtATimeLeavesTheRestNominal) {
  const std::vector<Factor> factors = {Words(), Range("a", 0, 2, 3)};
  EXPECT_THAT(DesignPoints({.type = DesignType::kOneAtATime}, factors, {"tube", "1"}),
              ElementsAre(DesignPoint{"tube", "1"}, DesignPoint{"plate", "1"},
                          DesignPoint{"tube", "0"}, DesignPoint{"tube", "2"}));
}

TEST(Design, LatinHypercubeUsesEverySliceOnce) {
  const DesignConfig design{.type = DesignType::kLatinHypercube, .points = 50, .seed = 3};
  const auto points = DesignPoints(design, {Range("a", 0, 1), Range("b", 10, 20)}, {});
  std::set<int> of_a, of_b;
  for (const DesignPoint& point : points) {
    of_a.insert(static_cast<int>(*NumberOf(point[0]) * 50));
    of_b.insert(static_cast<int>((*NumberOf(point[1]) - 10) * 5));
  }
  EXPECT_EQ(of_a.size(), 50u);
  EXPECT_EQ(of_b.size(), 50u);
}

TEST(Design, AFactorMoreChangesNoOther) {
  const DesignConfig design{.type = DesignType::kLatinHypercube, .points = 8, .seed = 3};
  const auto alone = DesignPoints(design, {Range("a", 0, 1)}, {});
  const auto with = DesignPoints(design, {Range("b", 0, 1), Range("a", 0, 1)}, {});
  for (std::size_t i = 0; i < alone.size(); ++i) EXPECT_EQ(alone[i][0], with[i][1]);
}

}  // namespace
}  // namespace windhover
