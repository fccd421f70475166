#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "eval/gates.h"
#include "eval/metrics.h"
#include "eval/run_record.h"
#include "eval/samples.h"
#include "eval/swarm_metrics.h"

namespace windhover {

/// Stereo frames of the run: annotated by render, and answered by the estimator.
struct FrameCounts {
  int sent = 0;
  int received = 0;
  int lost() const { return sent - received; }
};

/// A run and all that can be said about it. The score follows from the log alone; what was
/// measured by a wall clock is copied from timing.json when that lies beside the log.
struct Evaluation {
  RunRecord run;
  TargetFrames targets;
  FrameCounts frames;
  std::vector<MethodScore> methods;
  std::vector<SwarmTick> swarm_ticks;
  SwarmMetrics swarm;
  /// Median of measured minus true disparity of the detected boxes, px: what a scenario that
  /// flies the same rig again should give as estimator.offset1_px.
  std::optional<double> disparity_offset_px;
  nlohmann::ordered_json timing;    ///< Null when there is no timing.json.
  nlohmann::ordered_json manifest;  ///< Null when there is no manifest.json.
  std::vector<GateResult> gates;
  std::string verdict;           ///< pass | fail | invalid
  nlohmann::ordered_json score;  ///< The content of score.json.
};

/// Scores a run directory, or a bare log.
/// @throws std::runtime_error if the log cannot be read; says what is wrong with it.
Evaluation Evaluate(const std::filesystem::path& run_dir_or_log);

/// Scores a flight that is already in memory.
Evaluation EvaluateRecord(RunRecord run, nlohmann::ordered_json timing = nullptr,
                          nlohmann::ordered_json manifest = nullptr);

/// Each writes one file into `dir`: score.json, estimates.csv, swarm.csv, junit.xml, report.html.
/// @throws std::runtime_error naming the file if it cannot be written.
void WriteScore(const Evaluation& evaluation, const std::filesystem::path& dir);
void WriteEstimatesCsv(const Evaluation& evaluation, const std::filesystem::path& dir);
void WriteSwarmCsv(const Evaluation& evaluation, const std::filesystem::path& dir);
void WriteJunit(const Evaluation& evaluation, const std::filesystem::path& dir);
/// Embeds the pictures of `dir`/frames, if there are any (eval/report_frames.h).
void WriteReport(const Evaluation& evaluation, const std::filesystem::path& dir);

/// junit.xml of a run that left no log to score: one failing test case with the reason.
void WriteJunitOfDeadRun(const std::string& reason, const std::filesystem::path& dir);

}  // namespace windhover
