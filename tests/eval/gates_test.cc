#include "eval/gates.h"

#include <ostream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace windhover {
namespace {

using ::testing::HasSubstr;

const nlohmann::ordered_json kScore = nlohmann::ordered_json::parse(R"({
  "methods": {
    "baseline": {"n": 100, "abs_rel": 0.05, "nees": null, "ci95": {"abs_rel": [0.04, 0.07]},
                 "lt20": {"n": 0, "detected": 0},
                 "by_distance": [{"from_m": 5, "n": 9, "abs_rel": 0.02},
                                 {"from_m": 25, "n": 7, "abs_rel": 0.08,
                                  "ci95": {"abs_rel": [0.06, 0.09]}}]}},
  "swarm": {"collisions": 0, "min_separation_m": 2.5}})");

GateResult Judge(const Expectation& expectation) {
  return EvaluateGates(kScore, std::span(&expectation, 1)).at(0);
}

TEST(EvaluateGates, MaxAndMinLookAtTheValue) {
  EXPECT_TRUE(Judge({.metric = "methods.baseline.abs_rel", .max = 0.05}).pass);
  EXPECT_FALSE(Judge({.metric = "methods.baseline.abs_rel", .max = 0.049}).pass);
  EXPECT_TRUE(Judge({.metric = "swarm.min_separation_m", .min = 2.5}).pass);
  EXPECT_FALSE(Judge({.metric = "swarm.min_separation_m", .min = 2.6}).pass);
  EXPECT_TRUE(Judge({.metric = "swarm.collisions", .max = 0}).pass);
}

TEST(EvaluateGates, Upper95AndLower95LookAtTheInterval) {
  EXPECT_TRUE(Judge({.metric = "methods.baseline.abs_rel", .upper95 = 0.071}).pass);
  EXPECT_FALSE(Judge({.metric = "methods.baseline.abs_rel", .upper95 = 0.06}).pass);
  EXPECT_TRUE(Judge({.metric = "methods.baseline.abs_rel", .lower95 = 0.039}).pass);
  EXPECT_FALSE(Judge({.metric = "methods.baseline.abs_rel", .lower95 = 0.045}).pass);
  EXPECT_EQ(Judge({.metric = "methods.baseline.abs_rel", .upper95 = 0.06}).value, 0.07);
}

TEST(EvaluateGates, ABinByDistanceGoesByWhereItBegins) {
  EXPECT_EQ(Judge({.metric = "methods.baseline.by_distance.25.abs_rel", .max = 1}).value, 0.08);
  EXPECT_EQ(Judge({.metric = "methods.baseline.by_distance.25.abs_rel", .upper95 = 1}).value, 0.09);
  const auto gate = Judge({.metric = "methods.baseline.by_distance.30.abs_rel", .max = 1});
  EXPECT_FALSE(gate.pass);
  EXPECT_THAT(gate.message, HasSubstr("no frames from 30 m on"));
}

TEST(EvaluateGates, SaysWhatFailed) {
  const auto gate = Judge({.metric = "methods.baseline.abs_rel", .upper95 = 0.06});
  EXPECT_EQ(gate.name, "methods.baseline.abs_rel upper95");
  EXPECT_EQ(gate.message, "0.07 must be at most 0.06");
}

struct WantOfEvidence {
  Expectation expectation;
  const char* message;

  friend std::ostream& operator<<(std::ostream& out, const WantOfEvidence& want) {
    return out << want.expectation.metric << ": " << want.message;
  }
};

class NothingPassesForWantOfEvidence : public ::testing::TestWithParam<WantOfEvidence> {};

TEST_P(NothingPassesForWantOfEvidence, Fails) {
  const auto gate = Judge(GetParam().expectation);
  EXPECT_FALSE(gate.pass);
  EXPECT_FALSE(gate.value);
  EXPECT_THAT(gate.message, HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    Gates, NothingPassesForWantOfEvidence,
    ::testing::Values(
        WantOfEvidence{{.metric = "methods.size.abs_rel", .max = 9},
                       "there is no metric 'methods.size.abs_rel': no 'size' among baseline"},
        WantOfEvidence{{.metric = "methods.baseline.abs_rel.x", .max = 9}, "no 'x'"},
        WantOfEvidence{{.metric = "", .max = 9}, "there is no metric"},
        WantOfEvidence{{.metric = "methods.baseline.nees", .max = 9}, "has no value"},
        WantOfEvidence{{.metric = "methods.baseline.lt20.detected", .max = 9}, "n = 0"},
        WantOfEvidence{{.metric = "methods.baseline", .max = 9}, "names a group"},
        WantOfEvidence{{.metric = "swarm.collisions", .upper95 = 9}, "no 95 % interval"},
        WantOfEvidence{{.metric = "methods.baseline.nees", .upper95 = 9}, "no 95 % interval"},
        WantOfEvidence{{.metric = "swarm.collisions"}, "has no limit"}));

TEST(EvaluateGates, MakesOneGateOfEachLimit) {
  const std::vector<Expectation> both{{.metric = "swarm.min_separation_m", .max = 3, .min = 2}};
  const auto gates = EvaluateGates(kScore, both);
  ASSERT_EQ(gates.size(), 2u);
  EXPECT_EQ(gates[0].kind, "max");
  EXPECT_EQ(gates[1].kind, "min");
}

}  // namespace
}  // namespace windhover
