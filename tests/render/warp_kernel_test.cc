#include "render/warp_kernel.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "common/random/random_stream.h"

namespace windhover {
namespace {

std::int32_t Below(RandomStream& stream, double limit) {
  return static_cast<std::int32_t>(stream.Uniform(0, limit));
}

constexpr int kWidth = 60, kHeight = 40, kPixels = 70;

MapWindow NoiseWindow() {
  RandomStream stream(1, "warp_kernel_test");
  MapWindow window;
  window.Resize(kWidth, kHeight);
  for (int v = 0; v < kHeight; ++v) {
    std::array<Texel, kWidth> row{};
    for (Texel& texel : row) {
      for (std::uint16_t& value : texel) value = static_cast<std::uint16_t>(Below(stream, 32768));
    }
    window.SetRow(v, row.data());
  }
  return window;
}

// Four cells and a piece of one, with their ends.
struct Places {
  std::array<std::int32_t, 6> u, v;
};

// Of each fourth trial wider than texels, of each third steeper than a row.
Places RandomPlaces(RandomStream& stream, int trial) {
  Places places{};
  const double step = (trial % 4 == 0 ? 1.3 : 0.85) * 16 * 65536;
  const double slope = trial % 3 == 0 ? stream.Uniform(-0.3, 0.3) : stream.Uniform(-0.03, 0.03);
  for (std::size_t i = 0; i < places.u.size(); ++i) {
    const double u = std::min(static_cast<double>(i) * step / 2 + stream.Uniform(0, 9e5),
                              (kWidth - 1.001) * 65536);
    places.u[i] = static_cast<std::int32_t>(u);
    places.v[i] =
        static_cast<std::int32_t>((kHeight / 2) * 65536 + slope * u + stream.Uniform(0, 65536));
  }
  return places;
}

std::vector<std::uint16_t> Warped(const MapWindow& window, const Places& places,
                                  InstructionSet isa) {
  std::vector<std::uint16_t> rgb(3 * kPixels + kRowMargin);
  WarpRow(window, {places.u.data(), places.v.data(), kPixels}, rgb.data(), isa);
  rgb.resize(3 * kPixels);
  return rgb;
}

// The mean of moments each a little after the other, and how much each weighs.
constexpr std::array<std::int32_t, kMaxWarpMoments> kShares = {3882, 7842, 9320, 7842, 3881};

std::vector<std::uint16_t> Mean(const MapWindow& window, std::span<const Places> moments,
                                InstructionSet isa = WidestInstructionSet()) {
  std::vector<WarpedRow> rows;
  std::int32_t rest = kWholeShare;
  for (std::size_t m = 0; m < moments.size(); ++m) {
    const std::int32_t share = m + 1 < moments.size() ? kShares[m] : rest;
    rest -= share;
    rows.push_back({moments[m].u.data(), moments[m].v.data(), kPixels, share});
  }
  std::vector<std::uint16_t> rgb(3 * kPixels + kRowMargin);
  WarpMeanRow(window, rows, rgb.data(), isa);
  rgb.resize(3 * kPixels);
  return rgb;
}

// Half way between two columns and a quarter between two rows, by hand.
TEST(WarpRow, InterpolatesBetweenFourTexels) {
  MapWindow window;
  window.Resize(2, 2);
  const std::array<Texel, 4> texels = {Texel{500, 0, 32767}, Texel{1500, 0, 32767},
                                       Texel{2500, 200, 32767}, Texel{3500, 200, 32767}};
  window.SetRow(0, texels.data());
  window.SetRow(1, texels.data() + 2);
  const std::array<std::int32_t, 2> u = {32768, 32768}, v = {16384, 16384};
  std::array<std::uint16_t, 3 + kRowMargin> rgb{};
  WarpRow(window, {u.data(), v.data(), 1}, rgb.data());
  EXPECT_NEAR(rgb[0], 3000, 2);
  EXPECT_NEAR(rgb[1], 100, 2);
  EXPECT_EQ(rgb[2], 65532);
}

// Against real numbers: weights are rounded by 1/65536, a value by a half, and white is 3 less.
TEST(WarpRow, InterpolatesToTwo) {
  const MapWindow window = NoiseWindow();
  RandomStream stream(3, "warp_kernel_test");
  for (int trial = 0; trial < 500; ++trial) {
    const std::int32_t u = Below(stream, (kWidth - 1.001) * 65536);
    const std::int32_t v = Below(stream, (kHeight - 1.001) * 65536);
    std::array<std::uint16_t, 3 + kRowMargin> rgb{};
    const std::array<std::int32_t, 2> us = {u, u}, vs = {v, v};
    WarpRow(window, {us.data(), vs.data(), 1}, rgb.data());
    const double right = u / 65536.0 - (u >> 16), below = v / 65536.0 - (v >> 16);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto at = [&](int du, int dv) {
        return static_cast<double>(window.At((u >> 16) + du, (v >> 16) + dv)[c]);
      };
      const double exact = (1 - below) * ((1 - right) * at(0, 0) + right * at(1, 0)) +
                           below * ((1 - right) * at(0, 1) + right * at(1, 1));
      EXPECT_NEAR(rgb[c], exact * 65532 / 32767, 3.5) << trial;
    }
  }
}

// A quarter of what is seen first and three quarters of what is seen last: of 1000 and 3000.
TEST(WarpMeanRow, WeighsMoments) {
  MapWindow window;
  window.Resize(3, 2);
  const std::array<Texel, 3> texels = {Texel{1000, 0, 32767}, Texel{3000, 400, 32767}, Texel{}};
  window.SetRow(0, texels.data());
  window.SetRow(1, texels.data());
  const std::array<std::int32_t, 2> first = {0, 0}, last = {65536, 65536}, v = {0, 0};
  const std::array<WarpedRow, 2> moments = {WarpedRow{first.data(), v.data(), 1, 8192},
                                            WarpedRow{last.data(), v.data(), 1, 24575}};
  std::array<std::uint16_t, 3 + kRowMargin> rgb{};
  WarpMeanRow(window, moments, rgb.data());
  EXPECT_NEAR(rgb[0], 2 * 2500, 2);
  EXPECT_NEAR(rgb[1], 2 * 300, 2);
  EXPECT_NEAR(rgb[2], 65532, 6);  // A texel of black takes 1/32767 at most a moment.
}

// Three weights a moment are rounded, by half of 1/32767 of texels that differ by up to white; a
// moment alone is true to 2, and its share of the mean to 2 more.
TEST(WarpMeanRow, IsTheMeanOfItsMoments) {
  const MapWindow window = NoiseWindow();
  RandomStream stream(4, "warp_kernel_test");
  for (int trial = 0; trial < 200; ++trial) {
    std::array<Places, kMaxWarpMoments> moments;
    std::vector<double> mean(3 * kPixels);
    for (std::size_t m = 0; m < moments.size(); ++m) {
      moments[m] = RandomPlaces(stream, trial);
      const auto alone = Warped(window, moments[m], InstructionSet::kSse2);
      for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += alone[i] * (kShares[m] / 32767.0);
    }
    const auto together = Mean(window, moments);
    for (std::size_t i = 0; i < mean.size(); ++i) {
      ASSERT_NEAR(together[i], mean[i], 3 * kMaxWarpMoments + 4) << trial;
    }
  }
}

// Weights sum to the shares exactly, and shares to one.
TEST(WarpMeanRow, KeepsOneColour) {
  MapWindow window;
  window.Resize(kWidth, kHeight);
  const std::vector<Texel> texels(kWidth, Texel{11111, 32767, 1});
  for (int v = 0; v < kHeight; ++v) window.SetRow(v, texels.data());
  RandomStream stream(5, "warp_kernel_test");
  for (int trial = 0; trial < 100; ++trial) {
    std::array<Places, kMaxWarpMoments> moments;
    for (Places& places : moments) places = RandomPlaces(stream, trial);
    const auto n = static_cast<std::size_t>(2 + trial % 4);
    ASSERT_EQ(Mean(window, {moments.data(), n}), Warped(window, moments[0], InstructionSet::kSse2));
  }
}

// Integers only, so the kernels must agree in every bit: along rows, steeply across them (where the
// widest kernel gives way), near the window's right edge; one moment and means of up to five.
TEST(WarpRow, GivesTheSameBitsOnEveryInstructionSet) {
  if (WidestInstructionSet() == InstructionSet::kSse2)
    GTEST_SKIP() << "this processor has only SSE2";
  const MapWindow window = NoiseWindow();
  RandomStream stream(2, "warp_kernel_test");
  for (int trial = 0; trial < 2000; ++trial) {
    std::array<Places, kMaxWarpMoments> moments;
    for (Places& places : moments) places = RandomPlaces(stream, trial);
    const std::span<const Places> some{moments.data(), static_cast<std::size_t>(1 + trial % 5)};
    const auto narrow = Warped(window, moments[0], InstructionSet::kSse2);
    const auto narrow_mean = Mean(window, some, InstructionSet::kSse2);
    ASSERT_EQ(Warped(window, moments[0], InstructionSet::kAvx2), narrow) << trial;
    ASSERT_EQ(Mean(window, some, InstructionSet::kAvx2), narrow_mean) << trial;
    if (WidestInstructionSet() == InstructionSet::kAvx512) {
      ASSERT_EQ(Warped(window, moments[0], InstructionSet::kAvx512), narrow) << trial;
      ASSERT_EQ(Mean(window, some, InstructionSet::kAvx512), narrow_mean) << trial;
    }
  }
}

}  // namespace
}  // namespace windhover
