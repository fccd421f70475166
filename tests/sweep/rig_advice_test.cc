#include "cli/rig_advice.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

using testing::HasSubstr;

/// 1 px of constant offset and nothing else, on a faultless rig.
std::string Requirement(const std::string& require) {
  return "description: d\n"
         "base: " WINDHOVER_SOURCE_DIR
         "/scenarios/ideal_geometric.yaml\n"
         "set: {rig: {misalignment: {offset_px: 1}}}\n"
         "factors: [{key: rig.focal_mm, values: [6, 12, 24]}]\n"
         "require: " +
         require + "\n";
}

AdviceRequest Load(const std::string& require) {
  const TemporaryFolder folder;
  return LoadAdviceRequest(folder.Write("r.yaml", Requirement(require)));
}

// Of a normal error without bias √(2/π) σ; of a bias without noise the bias. Both: by sampling
// quantiles, 3-4-5: b = 3, σ = 4 make 3.9936… (σ √(2/π) e^(−9/32) + 3 erf(3/(4√2)) = 2.4090
// + 1.6401).
TEST(RigAdvice, MeanAbsoluteErrorIsThatOfAFoldedNormal) {
  EXPECT_NEAR(MeanAbsolute_m({0, 2}), 2 * std::sqrt(2 / M_PI), 1e-12);
  EXPECT_EQ(MeanAbsolute_m({-3, 0}), 3);
  EXPECT_NEAR(MeanAbsolute_m({3, 4}), 2.4090 + 1.6401, 1e-3);
  EXPECT_EQ(MeanAbsolute_m({3, 4}), MeanAbsolute_m({-3, 4}));
}

// 1 px of 3215 · 0.406 / 20 = 65.3 px of disparity at 12 mm and 20 m: 1.53 %; half of that at 24
// mm. The box shows nothing else: `ideal` has no noise.
TEST(RigAdvice, OneErrorInClosedFormAndSimulated) {
  const AdviceRequest request = Load("{abs_rel: 0.02, distance_m: 20, confirm: 3, flights: 10}");
  const auto rigs = Advise(request);
  ASSERT_EQ(rigs.size(), 3u);
  EXPECT_EQ(request.rigs.points[rigs[0].point][0], "24") << "the best first";
  EXPECT_NEAR(rigs[1].abs_rel, 1 / 65.26, 1e-4);
  EXPECT_NEAR(rigs[0].abs_rel, rigs[1].abs_rel / 2, 1e-6);
  for (const RigAdvice& rig : rigs) {
    ASSERT_TRUE(rig.is_simulated);
    // The next order: a share of the error that is the error itself, 3 % at most.
    EXPECT_NEAR(rig.simulated_abs_rel / rig.abs_rel, 1, 0.035);
  }
  EXPECT_TRUE(Meets(request, rigs[1]));
  EXPECT_FALSE(Meets(request, rigs[2]));
}

// 1280 px · 3.7325 µm across: 2 atan(2.3888 / f) = 43.4°, 22.5°, 11.4°.
TEST(RigAdvice, LeavesOutWhatSeesTooLittle) {
  const AdviceRequest request =
      Load("{abs_rel: 0.02, distance_m: 20, field_of_view_deg: 20, confirm: 0}");
  const auto rigs = Advise(request);
  ASSERT_EQ(rigs.size(), 2u);
  EXPECT_NEAR(rigs[0].field_of_view_deg, 22.5, 0.05);
  EXPECT_NEAR(rigs[1].field_of_view_deg, 43.4, 0.05);
}

TEST(RigAdvice, SaysWhatIsWrongWithARequirement) {
  const auto mistake = [](const std::string& text) -> std::string {
    const TemporaryFolder folder;
    try {
      LoadAdviceRequest(folder.Write("r.yaml", text));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(mistake(Requirement("{abs_rel: 0, distanc_m: 3}")),
              HasSubstr("abs_rel: must be a number between 0.0001 and 1 (found '0')"));
  EXPECT_THAT(mistake(Requirement("{abs_rel: 0, distanc_m: 3}")),
              HasSubstr("did you mean 'distance_m'?"));
  EXPECT_THAT(mistake("description: d\n"), HasSubstr("require: must be a map"));
}

}  // namespace
}  // namespace windhover
