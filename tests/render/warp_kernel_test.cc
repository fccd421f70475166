#include "render/warp_kernel.h"

#include <algorithm>
#include <array>
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
  window.width = kWidth;
  window.height = kHeight;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    Texel texel{};
    for (std::size_t c = 0; c < 3; ++c) texel[c] = static_cast<std::uint16_t>(Below(stream, 65536));
    window.texels.push_back(texel);
  }
  return window;
}

// Four cells and a piece of one, with their ends.
struct Places {
  std::array<std::int32_t, 6> u, v;
};

std::vector<std::uint16_t> Warped(const MapWindow& window, const Places& places,
                                  InstructionSet isa) {
  std::vector<std::uint16_t> rgb(3 * kPixels + kRowMargin);
  WarpRow(window, {places.u.data(), places.v.data(), kPixels}, rgb.data(), isa);
  rgb.resize(3 * kPixels);
  return rgb;
}

// Half way between two columns and a quarter between two rows, by hand.
TEST(WarpRow, InterpolatesBetweenFourTexels) {
  MapWindow window;
  window.width = 2;
  window.height = 2;
  window.texels = {Texel{1000, 0, 65535, 0}, Texel{3000, 0, 65535, 0}, Texel{5000, 400, 65535, 0},
                   Texel{7000, 400, 65535, 0}};
  const std::array<std::int32_t, 2> u = {32768, 32768}, v = {16384, 16384};
  std::array<std::uint16_t, 3 + kRowMargin> rgb{};
  WarpRow(window, {u.data(), v.data(), 1}, rgb.data());
  EXPECT_NEAR(rgb[0], 3000, 4);  // Four cut products.
  EXPECT_NEAR(rgb[1], 100, 4);
  EXPECT_NEAR(rgb[2], 65535, 4);
}

// Integers only, so the kernels must agree in every bit: along rows, steeply across them (where the
// widest kernel gives way), near the window's right edge.
TEST(WarpRow, GivesTheSameBitsOnEveryInstructionSet) {
  if (WidestInstructionSet() == InstructionSet::kSse2)
    GTEST_SKIP() << "this processor has only SSE2";
  const MapWindow window = NoiseWindow();
  RandomStream stream(2, "warp_kernel_test");
  for (int trial = 0; trial < 2000; ++trial) {
    Places places{};
    const double step = (trial % 4 == 0 ? 1.3 : 0.85) * 16 * 65536;
    const double slope = trial % 3 == 0 ? stream.Uniform(-0.5, 0.5) : stream.Uniform(-0.03, 0.03);
    for (std::size_t i = 0; i < places.u.size(); ++i) {
      const double u = std::min(static_cast<double>(i) * step / 2 + stream.Uniform(0, 9e5),
                                (kWidth - 1.001) * 65536);
      places.u[i] = static_cast<std::int32_t>(u);
      places.v[i] =
          static_cast<std::int32_t>((kHeight / 2) * 65536 + slope * u + stream.Uniform(0, 65536));
    }
    const auto narrow = Warped(window, places, InstructionSet::kSse2);
    ASSERT_EQ(Warped(window, places, InstructionSet::kAvx2), narrow) << trial;
    if (WidestInstructionSet() == InstructionSet::kAvx512) {
      ASSERT_EQ(Warped(window, places, InstructionSet::kAvx512), narrow) << trial;
    }
  }
}

}  // namespace
}  // namespace windhover
