#include <cmath>

#include <fmt/format.h>

#include "common/config/enum_name.h"
#include "common/file/whole_file.h"
#include "eval/evaluation.h"
#include "eval/junit.h"

namespace windhover {
namespace {

constexpr const char* kColumns =
    "utime_us,observer,target,observe,detector,correction,detected,range_true_m,depth_true_m,"
    "range_uwb_m,range_est_m,range_sigma_m,x_left_px,y_left_px,w_left_px,h_left_px,x_right_px,"
    "y_right_px,w_right_px,h_right_px,stages,latency_us\n";

constexpr const char* kSwarmColumns =
    "utime_us,separation_m,order,connectivity,algebraic_connectivity,union_by_sight,commands,"
    "guarded,false_brakes,missed_brakes\n";

/// The shortest text that reads back as the same number; empty for one that is none.
std::string Cell(double number) { return std::isfinite(number) ? fmt::format("{}", number) : ""; }

std::string Cells(const image_box_t& box) {
  return fmt::format("{},{},{},{}", Cell(box.x_px), Cell(box.y_px), Cell(box.w_px), Cell(box.h_px));
}

std::string Row(const TargetFrame& frame, const std::string& observe, const std::string& method,
                const std::optional<MethodEstimate>& estimate) {
  std::string row = fmt::format("{},{},{},{},{},{},{},{},{},{},", frame.utime, frame.observer_id,
                                frame.truth.target_id, observe, frame.detector, method,
                                frame.box ? 1 : 0, Cell(frame.truth.range_m),
                                Cell(frame.truth.depth_m), frame.uwb_m ? Cell(*frame.uwb_m) : "");
  row += estimate ? fmt::format("{},{},", Cell(estimate->range_m), Cell(estimate->range_sigma_m))
                  : ",,";
  row += frame.box ? Cells(frame.box->left) + "," + Cells(frame.box->right) : ",,,,,,,";
  // In lock-step an estimate carries the time of its frame: simulated latency is 0.
  row += estimate ? fmt::format(",{},0\n", estimate->n_stages) : ",,\n";
  return row;
}

}  // namespace

void WriteScore(const Evaluation& evaluation, const std::filesystem::path& dir) {
  ReplaceFile(dir / "score.json", evaluation.score.dump(2) + "\n");
}

void WriteEstimatesCsv(const Evaluation& evaluation, const std::filesystem::path& dir) {
  const Scenario& scenario = evaluation.run.scenario;
  const std::string observe = NameOf(scenario.observe);
  std::string csv = kColumns;
  for (const TargetFrame& frame : evaluation.targets.frames) {
    for (std::size_t m = 0; m < frame.estimates.size(); ++m) {
      csv += Row(frame, observe, scenario.estimator.methods[m], frame.estimates[m]);
    }
  }
  ReplaceFile(dir / "estimates.csv", csv);
}

void WriteSwarmCsv(const Evaluation& evaluation, const std::filesystem::path& dir) {
  std::string csv = kSwarmColumns;
  const auto cell = [](const std::optional<double>& number) {
    return number ? Cell(*number) : std::string();
  };
  for (const SwarmTick& tick : evaluation.swarm_ticks) {
    csv += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", tick.utime, cell(tick.separation_m),
                       cell(tick.order), cell(tick.connectivity), cell(tick.algebraic_connectivity),
                       cell(tick.union_by_sight), tick.braking.commands, tick.braking.guarded,
                       tick.braking.false_brakes, tick.braking.missed_brakes);
  }
  ReplaceFile(dir / "swarm.csv", csv);
}

void WriteJunit(const Evaluation& evaluation, const std::filesystem::path& dir) {
  const RunRecord& run = evaluation.run;
  ReplaceFile(dir / "junit.xml",
              JunitXml(run.scenario.description, "the run is valid",
                       run.valid ? "" : "the run is INVALID: " + run.invalid_reason,
                       evaluation.gates));
}

void WriteJunitOfDeadRun(const std::string& reason, const std::filesystem::path& dir) {
  ReplaceFile(dir / "junit.xml",
              JunitXml("windhover", "the run is valid", "the run is INVALID: " + reason, {}));
}

}  // namespace windhover
