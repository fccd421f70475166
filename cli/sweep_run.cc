#include "cli/sweep_run.h"

#include <algorithm>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "cli/in_process_run.h"
#include "cli/process_run.h"
#include "cli/verdict.h"
#include "common/file/whole_file.h"
#include "eval/evaluation.h"
#include "eval/score_metric.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

// Measured: 21 MiB a geometric run; five processes and OSMesa or our rasteriser with images.
constexpr double kGeometricRun_mib = 64, kImageRun_mib = 1024;

bool HasImages(const Scenario& scenario) {
  return scenario.observe == Observe::kImage || scenario.observe == Observe::kAnnotated;
}

void WriteResolved(const Scenario& scenario, const fs::path& folder) {
  ReplaceFile(folder / "resolved.yaml", ResolvedYaml(scenario, PathStyle::kAbsolute));
}

RunSummary Fly(const Scenario& scenario, const fs::path& folder) {
  RunOptions options;
  options.quiet = true;
  options.no_report = true;
  if (!HasImages(scenario)) return RunInOneProcess(scenario, folder, options);
  WriteResolved(scenario, folder);
  return RunProcesses(scenario, folder, options);
}

/// Moves the folder of a run to failed/, if there is room. Workers take turns.
void Keep(const fs::path& folder, const std::string& name, const SweepRunOptions& options) {
  const fs::path failed = options.out / "failed";
  fs::create_directories(failed);
  const int lock = open(failed.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  flock(lock, LOCK_EX);
  fs::remove_all(failed / name);
  const auto n = std::distance(fs::directory_iterator(failed), fs::directory_iterator());
  if (n < options.keep) fs::rename(folder, failed / name);
  close(lock);
}

std::vector<std::optional<double>> MetricsOf(const nlohmann::ordered_json& score,
                                             const std::vector<std::string>& paths) {
  std::vector<std::optional<double>> metrics;
  for (const std::string& path : paths) {
    const FoundMetric found = FindMetric(score, path);
    metrics.push_back(found.value == nullptr ? std::nullopt : NumberIn(*found.value));
  }
  return metrics;
}

/// Scores a run; one that did not pass gets the files of a run's folder.
RunRow Score(const RunSummary& summary, const fs::path& folder, const SweepRunOptions& options) {
  RunRow row{.verdict = "invalid",
             .reason = fmt::format("{}: {}", summary.culprit, summary.reason),
             .metrics = {}};
  try {
    const Evaluation evaluation = Evaluate(folder);
    if (summary.valid) {
      row.verdict = evaluation.verdict;
      row.reason = evaluation.run.invalid_reason;
      if (row.valid()) row.metrics = MetricsOf(evaluation.score, options.metrics);
    }
    if (row.verdict == "pass") return row;
    WriteScoreFiles(evaluation, folder);
    WriteReport(evaluation, folder);
  } catch (const std::exception& error) {
    if (summary.valid) row.reason = error.what();
    WriteJunitOfDeadRun(row.reason, folder);
  }
  return row;
}

/// MiB that programs may have without swapping.
double AvailableMemory_mib() {
  std::ifstream in("/proc/meminfo");
  double kib = 0;
  for (std::string word; in >> word;) {
    if (word == "MemAvailable:") in >> kib;
  }
  return kib / 1024;
}

}  // namespace

RunRow RunAndScore(const Scenario& drawn, std::size_t point, const RunPlace& place,
                   const SweepRunOptions& options) {
  const fs::path folder = options.out / "work" / std::to_string(place.worker);
  fs::remove_all(folder);
  fs::create_directories(folder);
  const RunSummary summary = Fly(drawn, folder);
  RunRow row = Score(summary, folder, options);
  if (row.verdict != "pass" && !summary.interrupted) {
    if (!HasImages(drawn)) WriteResolved(drawn, folder);
    Keep(folder, fmt::format("point{}_seed{}", point, drawn.random_seed), options);
  }
  return row;
}

int JobsThatFit(const Scenario& scenario) {
  const double run_mib = HasImages(scenario) ? kImageRun_mib : kGeometricRun_mib;
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  return std::clamp(static_cast<int>(AvailableMemory_mib() / run_mib), 1, cores);
}

}  // namespace windhover
