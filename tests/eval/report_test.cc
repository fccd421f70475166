#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/random/random_stream.h"
#include "eval/evaluation.h"
#include "eval/report_flight.h"
#include "eval/report_frames.h"
#include "eval/report_view.h"
#include "eval/svg_chart.h"
#include "tests/eval/flight_fixture.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class ReportTest : public ::testing::Test {
 protected:
  std::string Report(const Evaluation& evaluation) const {
    WriteReport(evaluation, dir_);
    std::ifstream in(dir_ / "report.html");
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  }

  TemporaryFolder folder_;
  const std::filesystem::path& dir_ = folder_.path();
};

/// 40 s of a target that recedes from 5 to 40 m; `offset1` is noisy, `baseline` far too short.
RunRecord RecedingTarget() {
  RandomStream random(1, "estimates");
  std::vector<ObserverFrame> frames;
  for (int k = 0; k < 400; ++k) {
    const double range_m = 5 + 35 * k / 400.0;
    ObserverFrame frame = SeenFrame(UtimeOfTick(k, 10), TargetAhead(1, range_m, 640 + k % 50),
                                    range_m / (1 + 0.055 * range_m));
    frame.ranges->estimates.push_back(
        Estimate(0, "offset1", range_m * (1 + 0.004 * range_m * random.Normal()), 1));
    frame.ranges->estimates.push_back(
        Estimate(0, "size", range_m * (1.05 + 0.1 * random.Normal()), 0.1 * range_m));
    frame.ranges->n_estimates = 3;
    frames.push_back(frame);
  }
  RunRecord run = Flight(std::move(frames));
  run.scenario.description = "an orange M200 recedes & returns <fast>";
  run.scenario.estimator.methods = {"baseline", "offset1", "size"};
  run.scenario.estimator.in_loop = "offset1";
  run.scenario.expect = {{.metric = "methods.offset1.abs_rel_all", .upper95 = 0.1},
                         {.metric = "methods.fused.abs_rel_all", .upper95 = 0.1},
                         {.metric = "methods.baseline.abs_rel", .max = 0.2}};
  return run;
}

TEST_F(ReportTest, IsOneFileThatNeedsNoNetwork) {
  const std::string html = Report(EvaluateRecord(RecedingTarget()));
  EXPECT_THAT(html, Not(HasSubstr("http")));
  EXPECT_THAT(html, Not(HasSubstr("src=")));
  EXPECT_THAT(html, HasSubstr("<style>"));
}

TEST_F(ReportTest, TellsTheVerdictAndWhy) {
  const std::string html = Report(EvaluateRecord(RecedingTarget()));
  EXPECT_THAT(html, HasSubstr("<header class=\"fail\"><h1>FAIL</h1>"));
  EXPECT_THAT(html, HasSubstr("1 / 3"));
  EXPECT_THAT(html, HasSubstr("there is no metric 'methods.fused.abs_rel_all'"));
}

TEST_F(ReportTest, EscapesWhatTheScenarioSays) {
  const std::string html = Report(EvaluateRecord(RecedingTarget()));
  EXPECT_THAT(html, HasSubstr("recedes &amp; returns &lt;fast&gt;"));
  EXPECT_THAT(html, Not(HasSubstr("<fast>")));
}

TEST_F(ReportTest, DrawsEveryMethodAndTheReference) {
  const std::string html = Report(EvaluateRecord(RecedingTarget()));
  EXPECT_THAT(html, HasSubstr("<path class=\"line truth\""));
  for (const char* look : {"mark s0", "mark s1", "mark s2"}) EXPECT_THAT(html, HasSubstr(look));
  EXPECT_THAT(html, Not(ContainsRegex("[^a-z](nan|inf)[^a-z]")));
}

TEST_F(ReportTest, TellsWhatAStageCosts) {
  const nlohmann::json timing = {
      {"wall_s", 4},
      {"stages",
       {{"render-0", {{{"stage", "draw"}, {"n", 200}, {"wall_ms", 8100}, {"cpu_ms", 40}}}},
        {"broken", {1, 2}}}}};
  EXPECT_THAT(Report(EvaluateRecord(RecedingTarget(), timing, nullptr)),
              HasSubstr("<td>render-0</td><td>draw</td><td>200</td><td>40.5</td><td>0.2</td>"));
}

TEST_F(ReportTest, OfAnEmptyRunIsStillAReport) {
  const std::string html = Report(EvaluateRecord(Flight({})));
  EXPECT_THAT(html, HasSubstr("</html>"));
  EXPECT_THAT(html, Not(ContainsRegex("[^a-z](nan|inf)[^a-z]")));
}

TEST_F(ReportTest, EmbedsPicturesWithTheirBoxes) {
  folder_.Write("frames/100000_0_left.png", "picture");
  folder_.Write("frames/100000_2_left.png", "of another aircraft");
  folder_.Write("frames/notes.txt", "text");
  RunRecord run = RecedingTarget();
  run.frames[1].truth.targets[0].left.visible = Box(99.5, 49.5, 40, 20);
  const std::string html = Report(EvaluateRecord(std::move(run)));
  EXPECT_THAT(html, HasSubstr("data:image/png;base64,cGljdHVyZQ=="));
  EXPECT_THAT(html, HasSubstr("class=\"truth-box\" x=\"80.00\" y=\"40.00\" width=\"40.00\""));
  EXPECT_THAT(html, HasSubstr("t = 0.10 s"));
  EXPECT_THAT(html, Not(HasSubstr(Base64("of another aircraft"))));
}

TEST(Base64, AgreesWithTheRfc) {  // RFC 4648, section 10.
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foo"), "Zm9v");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
}

TEST(NiceTicks, AreRound) {
  EXPECT_THAT(NiceTicks(40), ElementsAre(0, 10, 20, 30, 40));
  EXPECT_THAT(NiceTicks(1), ElementsAre(0, 0.2, 0.4, ::testing::DoubleEq(0.6), 0.8, 1));
  EXPECT_THAT(NiceTicks(0), ElementsAre(0));
}

// Seen for a second, and for one more after ten: two lines, "M… L…" each.
TEST_F(ReportTest, ReferenceLineEndsWhereTheTargetIsOutOfView) {
  std::vector<ObserverFrame> frames;
  for (int k = 0; k < 120; ++k) {
    if (k < 10 || k >= 110) frames.push_back(SeenFrame(UtimeOfTick(k, 10), TargetAhead(1, 10), 10));
  }
  EXPECT_THAT(Report(EvaluateRecord(Flight(frames))),
              ContainsRegex("class=\"line truth\" d=\"M[^M\"]*M[^M\"]*\""));
}

// Target 1 at (640, 360), 40 by 20 px; target 2 comes a tick later and is not detected. A third
// tick has neither, and aircraft 5 sees more, which is not drawn.
TEST(ObserverView, WorkedExample) {
  std::vector frames = {
      SeenFrame(0, TargetAhead(1, 10), 10), SeenFrame(100'000, TargetAhead(1, 10), 10),
      MissedFrame(200'000, TargetAhead(1, 10)), SeenFrame(200'000, TargetAhead(9, 10), 10)};
  frames[1].truth.targets.push_back(TargetAhead(2, 10, 300.5));
  frames[2].truth.targets[0].left.visible.w_px = 0;
  frames[3].observer_id = 5;
  const std::string html = ObserverView(Flight(frames));
  EXPECT_THAT(html, HasSubstr("attributeName=\"x\" dur=\"0.2s\" repeatCount=\"indefinite\" "
                              "calcMode=\"discrete\" values=\"620;620;-9999\""));
  EXPECT_THAT(html, HasSubstr("values=\"-9999;281;-9999\""));
  EXPECT_THAT(html, ContainsRegex("detected-box[^\n]*values=\"40;40;0\""));
  EXPECT_THAT(html, HasSubstr("<text class=\"box-label\" dy=\"-8\">2<"));
  EXPECT_THAT(html, Not(HasSubstr(">9<")));
  EXPECT_EQ(ObserverView(Flight({})), "");
  frames[0].detections->boxes[0].left.x_px = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(ObserverView(Flight(frames)), Not(HasSubstr("nan")));
}

uav_truth_t At(int id, double east_m, double north_m) {
  uav_truth_t uav{};
  uav.id = id;
  uav.p_WB_m[0] = east_m;
  uav.p_WB_m[1] = north_m;
  return uav;
}

/// Aircraft 3 flies 10 m east in 1 s, past aircraft 7, 2 m north of the middle of its way.
RunRecord PassingBy() {
  RunRecord run = Flight({});
  for (int k = 0; k <= 10; ++k) {
    world_truth_t tick{};
    tick.utime = UtimeOfTick(k, 10);
    tick.uavs = {At(3, k, 0), At(7, 5, 2)};
    tick.n_uavs = 2;
    run.world.push_back(tick);
  }
  return run;
}

TEST(SeparationChart, MarksTheLeastDistance) {
  EXPECT_THAT(SeparationChart(PassingBy()), HasSubstr("2.00 m: 3 and 7 at 0.5 s"));
  RunRecord alone = PassingBy();
  for (world_truth_t& tick : alone.world) tick.uavs.pop_back();
  EXPECT_EQ(SeparationChart(alone), "");
  EXPECT_THAT(FlightViews(alone), Not(HasSubstr("closest")));
}

// 454 px for 11.2 m, 0.6 m of it left of where aircraft 3 begins: 40.54 px a metre. One pixel is
// as long up as across: 7 is 2 m above the path of 3.
TEST(FlightViews, WorkedExample) {
  const std::string html = FlightViews(PassingBy());
  EXPECT_THAT(html, HasSubstr("<path id=\"above-3\" class=\"line s0\" d=\"M76.3 "));
  EXPECT_THAT(html, ContainsRegex("id=\"above-3\"[^/]*L481.7 [0-9.]+\"/>"));
  EXPECT_THAT(html, HasSubstr("id=\"above-7\" class=\"line s1\" d=\"M279.0 "));
  EXPECT_THAT(html, HasSubstr("dur=\"1s\""));
  RunRecord broken = PassingBy();
  broken.world[3].uavs[0].p_WB_m[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(FlightViews(broken), "");
}

}  // namespace
}  // namespace windhover
