#include "eval/evaluation.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/eval/flight_fixture.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class EvaluationTest : public ::testing::Test {
 protected:
  std::string Read(const std::string& name) const {
    std::ifstream in(dir_ / name);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  }

  TemporaryFolder folder_;
  const std::filesystem::path& dir_ = folder_.path();
};

/// Ten seconds at 10 Hz, target at 10 m; estimates alternate between 11 m and 9.5 m.
RunRecord TenSeconds() {
  std::vector<ObserverFrame> frames;
  for (int k = 0; k < 100; ++k) {
    frames.push_back(SeenFrame(UtimeOfTick(k, 10), TargetAhead(1, 10), k % 2 == 0 ? 11 : 9.5));
  }
  return Flight(std::move(frames));
}

TEST_F(EvaluationTest, ScoreHasTheKeysOfTheContract) {
  const auto score = EvaluateRecord(TenSeconds()).score;
  EXPECT_EQ(score["scenario"], "a flight made for a test");
  EXPECT_EQ(score["valid"], true);
  EXPECT_EQ(score["verdict"], "pass");
  EXPECT_EQ(score["frames"]["sent"], 100);
  EXPECT_EQ(score["frames"]["received"], 100);
  EXPECT_EQ(score["frames"]["lost"], 0);
  const auto& baseline = score["methods"]["baseline"];
  EXPECT_EQ(baseline["n"], 100);
  EXPECT_NEAR(baseline["abs_rel"].get<double>(), 0.075, 1e-12);
  for (const char* key :
       {"detected", "abs_rel_all", "abs_rel", "sq_rel", "rmse_m", "bias_m", "delta_1_25", "nees",
        "coverage_95", "by_distance", "lt20", "gt20", "ci95", "disparity_offset_px"}) {
    EXPECT_TRUE(baseline.contains(key)) << key;
  }
  for (const char* key : {"from_m", "to_m", "n", "abs_rel", "sq_rel", "bias_m"}) {
    EXPECT_TRUE(baseline["by_distance"][0].contains(key)) << key;
  }
  EXPECT_EQ(baseline["ci95"]["abs_rel"].size(), 2u);
  for (const char* key :
       {"min_separation_m", "collisions", "near_misses", "order", "connectivity"}) {
    EXPECT_TRUE(score["swarm"].contains(key)) << key;
  }
  EXPECT_TRUE(score.contains("seed"));
  EXPECT_TRUE(score.contains("timing"));
  EXPECT_TRUE(score.contains("gates"));
}

TEST_F(EvaluationTest, VerdictFollowsGatesAndValidity) {
  RunRecord run = TenSeconds();
  run.scenario.expect = {{.metric = "methods.baseline.abs_rel_all", .max = 0.08}};
  EXPECT_EQ(EvaluateRecord(run).verdict, "pass");
  run.scenario.expect = {{.metric = "methods.baseline.abs_rel_all", .max = 0.07}};
  EXPECT_EQ(EvaluateRecord(run).verdict, "fail");
  run.valid = false;
  EXPECT_EQ(EvaluateRecord(run).verdict, "invalid");
}

TEST_F(EvaluationTest, AMissedFrameIsNeverAGoodOne) {
  RunRecord run = TenSeconds();
  for (std::size_t k = 0; k < 50; ++k)
    run.frames[k] = MissedFrame(run.frames[k].utime, TargetAhead(1, 10));
  const auto baseline = EvaluateRecord(run).score["methods"]["baseline"];
  EXPECT_EQ(baseline["detected"], 50);
  EXPECT_NEAR(baseline["abs_rel_all"].get<double>(), (1 + 0.075) / 2, 1e-12);
}

TEST_F(EvaluationTest, AFrameWithoutAnAnswerMakesTheRunInvalid) {
  RunRecord run = TenSeconds();
  run.frames[3].ranges.reset();
  const Evaluation evaluation = EvaluateRecord(run);
  EXPECT_EQ(evaluation.frames.lost(), 1);
  EXPECT_EQ(evaluation.verdict, "invalid");
  EXPECT_THAT(evaluation.run.invalid_reason, HasSubstr("1 of 100 stereo frames"));
}

TEST_F(EvaluationTest, DisparityOffsetIsMeasuredMinusTrue) {
  RunRecord run = TenSeconds();
  const StereoRig rig = run.scenario.rig.calibrated.ToStereoRig();
  const double true_px = rig.left.fx_px() * rig.baseline_m / 10;
  for (ObserverFrame& frame : run.frames) {
    stereo_box_t& box = frame.detections->boxes[0];
    box.right.x_px = box.left.x_px - (true_px + 66);
  }
  // No distortion in the scenario, so pixels and the image plane differ by f alone; 1e-9: rounding.
  EXPECT_NEAR(*EvaluateRecord(run).disparity_offset_px, 66, 1e-9);
}

TEST_F(EvaluationTest, ScoreIsTheSameTwice) {
  EXPECT_EQ(EvaluateRecord(TenSeconds()).score.dump(), EvaluateRecord(TenSeconds()).score.dump());
}

TEST_F(EvaluationTest, EstimatesCsvWorkedExample) {
  ObserverFrame frame = SeenFrame(100'000, TargetAhead(1, 10, 640), 11, 0.5);
  frame.uwb_m[1] = 10.25;
  RunRecord run = Flight({frame, MissedFrame(200'000, TargetAhead(1, 12))});
  run.scenario.observe = Observe::kAnnotated;
  WriteEstimatesCsv(EvaluateRecord(run), dir_);
  EXPECT_EQ(Read("estimates.csv"),
            "utime_us,observer,target,observe,detector,correction,detected,range_true_m,"
            "depth_true_m,range_uwb_m,range_est_m,range_sigma_m,x_left_px,y_left_px,w_left_px,"
            "h_left_px,x_right_px,y_right_px,w_right_px,h_right_px,stages,latency_us\n"
            "100000,0,1,annotated,test,baseline,1,10,10,10.25,11,0.5,640,360,40,20,590,360,40,20,"
            "0,0\n"
            "200000,0,1,annotated,test,baseline,0,12,12,,,,,,,,,,,,,\n");
}

// Two 3 m apart that fly one way, blind to each other, then one of them alone in the world.
TEST_F(EvaluationTest, SwarmCsvWorkedExample) {
  RunRecord run = Flight({MissedFrame(0, TargetAhead(1, 3))});
  run.frames[0].truth.targets[0].left.in_front = 0;
  world_truth_t both{}, one{};
  both.uavs.resize(2);
  both.uavs[1].id = 1;
  both.uavs[1].p_WB_m[0] = 3;
  both.uavs[0].v_WB_mps[1] = both.uavs[1].v_WB_mps[1] = 2;
  one.utime = 100'000;
  one.uavs.resize(1);
  run.world = {both, one};
  WriteSwarmCsv(EvaluateRecord(run), dir_);
  EXPECT_EQ(Read("swarm.csv"),
            "utime_us,separation_m,order,connectivity,algebraic_connectivity,union_by_sight,"
            "commands,guarded,false_brakes,missed_brakes\n"
            "0,3,1,0.5,0,0,0,0,0,0\n"
            "100000,,,,,,0,0,0,0\n");
}

TEST_F(EvaluationTest, JunitHasOneCaseAGateAndOneForValidity) {
  RunRecord run = TenSeconds();
  run.scenario.expect = {{.metric = "methods.baseline.abs_rel_all", .max = 0.08},
                         {.metric = "methods.<b>.abs_rel", .max = 1}};
  WriteJunit(EvaluateRecord(run), dir_);
  const std::string junit = Read("junit.xml");
  EXPECT_THAT(junit, HasSubstr("tests=\"3\" failures=\"1\""));
  EXPECT_THAT(junit, HasSubstr("name=\"methods.baseline.abs_rel_all max\"/>"));
  EXPECT_THAT(junit, HasSubstr("methods.&lt;b&gt;.abs_rel max"));
  EXPECT_THAT(junit, Not(HasSubstr("<b>")));
}

TEST_F(EvaluationTest, ADeadRunLeavesAFailingJunit) {
  WriteJunitOfDeadRun("render-0 died", dir_);
  EXPECT_THAT(Read("junit.xml"),
              HasSubstr("<failure message=\"the run is INVALID: render-0 died\""));
}

TEST_F(EvaluationTest, NamesTheFileThatItCannotWrite) {
  try {
    WriteScore(EvaluateRecord(TenSeconds()), dir_ / "missing");
    FAIL() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("missing/score.json"));
  }
}

}  // namespace
}  // namespace windhover
