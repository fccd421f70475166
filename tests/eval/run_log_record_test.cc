#include "eval/run_log_record.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/channels.h"
#include "common/bus/run_log.h"
#include "common/bus/truth_channels.h"
#include "eval/evaluation.h"
#include "lcmtypes/run_end_t.hpp"
#include "lcmtypes/run_header_t.hpp"
#include "tests/eval/flight_fixture.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

using ::testing::HasSubstr;

Scenario TwoAircraft() {
  Scenario scenario;
  scenario.description = "a log made for a test";
  scenario.random_seed = 5;
  scenario.score.reference = ScoreReference::kUwb;
  scenario.aircraft.resize(2);
  scenario.aircraft[0].self.carries_rig = true;
  scenario.aircraft[1].self.id = 1;
  scenario.aircraft[1].position_m = {10, 0, 0};
  return scenario;
}

class RunLogRecordTest : public ::testing::Test {
 protected:
  std::filesystem::path log() const { return folder_.path() / "run.lcm"; }

  static void WriteHeader(RunLogWriter* writer) {
    run_header_t header{};
    header.version = "9.9.9";
    header.resolved_yaml = LogHeaderYaml(TwoAircraft());
    writer->Write(channel::kRunHeader, 0, header);
  }

  /// Frame `k`: aircraft 1 is at 10 m by truth, at 10.5 m by UWB and at 11 m by the estimator.
  static void WriteFrame(RunLogWriter* writer, int k, bool with_range = true) {
    ObserverFrame frame = SeenFrame(UtimeOfTick(k, 10), TargetAhead(1, 10), 11);
    frame.detections->utime = frame.ranges->utime = frame.utime;
    uwb_t uwb{};
    uwb.utime = frame.utime;
    uwb.n_ranges = 1;
    uwb.ranges.resize(1);
    uwb.ranges[0].target_id = 1;
    uwb.ranges[0].range_m = 10.5;
    writer->Write(channel::Uwb(0), frame.utime, uwb);
    writer->Write(channel::Annotation(0), frame.utime, frame.truth);
    writer->Write(channel::Detection(0), frame.utime, *frame.detections);
    if (with_range) writer->Write(channel::Range(0), frame.utime, *frame.ranges);
    velocity_command_t command{};
    command.utime = frame.utime;
    command.wish_WB_mps[1] = k;
    writer->Write(channel::VelocityCommand(0), frame.utime, command);
  }

  static void WriteEnd(RunLogWriter* writer, int n_ticks, bool valid = true,
                       const std::string& reason = "") {
    run_end_t end{};
    end.n_ticks = n_ticks;
    end.valid = valid;
    end.reason = reason;
    writer->Write(channel::kRunEnd, UtimeOfTick(n_ticks, 10), end);
  }

  /// Fifty frames of a good run.
  void WriteGoodLog() const {
    RunLogWriter writer(log());
    WriteHeader(&writer);
    for (int k = 0; k < 50; ++k) WriteFrame(&writer, k);
    WriteEnd(&writer, 50);
    writer.Flush();
  }

  TemporaryFolder folder_;
};

TEST_F(RunLogRecordTest, ReadsWhatWasFlown) {
  WriteGoodLog();
  const RunRecord run = ReadRunRecord(log());
  EXPECT_TRUE(run.valid) << run.invalid_reason;
  EXPECT_EQ(run.version, "9.9.9");
  EXPECT_EQ(run.scenario.random_seed, 5u);
  ASSERT_EQ(run.frames.size(), 50u);
  EXPECT_EQ(run.frames[7].utime, 700'000);
  EXPECT_EQ(run.frames[7].truth.targets.at(0).range_m, 10);
  EXPECT_EQ(run.frames[7].uwb_m.at(1), 10.5);
  EXPECT_EQ(run.frames[7].ranges->estimates.at(0).range_m, 11);
  ASSERT_EQ(run.commands.size(), 50u);
  EXPECT_EQ(run.commands[7].wish_WB_mps[1], 7);
}

TEST_F(RunLogRecordTest, ScoresARunFolderAndABareLogAlike) {
  WriteGoodLog();
  const Evaluation of_log = Evaluate(log());
  EXPECT_EQ(of_log.verdict, "pass");
  EXPECT_NEAR(*of_log.methods[0].all.bias_m, 0.5, 1e-12);
  EXPECT_EQ(Evaluate(folder_.path()).score.dump(), of_log.score.dump());
}

TEST_F(RunLogRecordTest, CopiesTheTimingThatLiesBesideTheLog) {
  WriteGoodLog();
  folder_.Write("timing.json", R"({"real_time_factor": 0.5, "hosts": 1})");
  EXPECT_EQ(Evaluate(log()).score["timing"].dump(), R"({"real_time_factor":0.5})");
  folder_.Write("timing.json", "{broken");
  EXPECT_TRUE(Evaluate(log()).score["timing"].is_null());
}

TEST_F(RunLogRecordTest, ARunThatWasCutShortIsInvalid) {
  RunLogWriter writer(log());
  WriteHeader(&writer);
  WriteFrame(&writer, 0);
  writer.Flush();
  EXPECT_FALSE(ReadRunRecord(log()).valid);
  EXPECT_THAT(ReadRunRecord(log()).invalid_reason, HasSubstr("cut short"));
  EXPECT_EQ(ReadRunRecord(log()).frames.size(), 1u);
  EXPECT_EQ(Evaluate(log()).verdict, "invalid");
}

TEST_F(RunLogRecordTest, KeepsTheReasonOfAnInvalidRun) {
  RunLogWriter writer(log());
  WriteHeader(&writer);
  WriteEnd(&writer, 0, /*valid=*/false, "render-0 died");
  writer.Flush();
  EXPECT_EQ(ReadRunRecord(log()).invalid_reason, "render-0 died");
}

TEST_F(RunLogRecordTest, MissingFramesMakeTheRunInvalid) {
  RunLogWriter writer(log());
  WriteHeader(&writer);
  WriteFrame(&writer, 0);
  WriteFrame(&writer, 1, /*with_range=*/false);
  WriteEnd(&writer, 3);
  writer.Flush();
  EXPECT_THAT(ReadRunRecord(log()).invalid_reason,
              HasSubstr("3 ticks of 1 stereo rigs should have 3 ANNOTATION messages (found 2)"));
  EXPECT_EQ(Evaluate(log()).frames.lost(), 1);
}

TEST_F(RunLogRecordTest, DamageMakesTheRunInvalid) {
  WriteGoodLog();
  std::fstream file(log(), std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(std::filesystem::file_size(log()) / 2));
  file << std::string(300, '\x5a');
  file.close();
  const Evaluation evaluation = Evaluate(log());
  EXPECT_EQ(evaluation.verdict, "invalid");
  EXPECT_THAT(evaluation.run.invalid_reason, HasSubstr("damaged"));
}

TEST_F(RunLogRecordTest, RefusesWhatIsNoLogOfOurs) {
  EXPECT_THROW(ReadRunRecord(folder_.path() / "missing.lcm"), std::runtime_error);
  RunLogWriter writer(log());
  WriteEnd(&writer, 0);
  writer.Flush();
  try {
    ReadRunRecord(log());
    FAIL() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("run.lcm: there is no RUN_HEADER"));
  }
}

}  // namespace
}  // namespace windhover
