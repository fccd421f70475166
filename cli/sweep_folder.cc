#include "cli/sweep_folder.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "cli/command.h"
#include "cli/tool.h"
#include "common/config/fields.h"
#include "common/file/whole_file.h"
#include "eval/junit.h"
#include "sweep/sweep_analysis.h"
#include "sweep/sweep_figures.h"
#include "sweep/sweep_report.h"
#include "sweep/sweep_table.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// The workers of a killed sweep end at once; a sweep that runs does not.
constexpr auto kLockTimeout = std::chrono::seconds(5);
constexpr const char* kLockFile = "lock";

Json ShardJson(const ProcessShare& share) {
  return {{"index", share.index}, {"count", share.count}};
}

Json ReadJsonFile(const fs::path& file) {
  std::ifstream in(file);
  return Json::parse(in, nullptr, /*allow_exceptions=*/false);
}

[[noreturn]] void MustBe(const std::string& where, const std::string& must,
                         const std::string& found) {
  throw ConfigError(fmt::format("{}: must be {} (found {})", where, must, found));
}

bool IsEmpty(const fs::path& folder) {
  return std::all_of(fs::directory_iterator(folder), fs::directory_iterator(),
                     [](const auto& entry) { return entry.path().filename() == kLockFile; });
}

/// Whether the runs of a point are all there: as many as there are to be, or enough for the rule.
bool IsWhole(const SweepPlan& plan, const RunRows& rows, int point) {
  const auto metric = static_cast<std::size_t>(
      std::find(plan.metrics.begin(), plan.metrics.end(), plan.config.stop.metric) -
      plan.metrics.begin());
  std::vector<std::optional<double>> values;
  for (int i = 0; i < plan.config.seeds.count; ++i) {
    const auto row = rows.find({point, plan.SeedOf(i)});
    if (row == rows.end()) return false;
    const auto& metrics = row->second.metrics;
    values.push_back(metric < metrics.size() ? metrics[metric] : std::nullopt);
    if (IsNarrowEnough(plan.config.stop, values)) return true;
  }
  return true;
}

void AddShard(const std::string& folder, RunRows* all) {
  for (const auto& [key, row] : ReadJournal(fs::path(folder) / "runs.jsonl")) {
    const auto [known, is_new] = all->emplace(key, row);
    if (is_new || (known->second.verdict == row.verdict && known->second.metrics == row.metrics)) {
      continue;
    }
    MustBe(folder + "/runs.jsonl", "the same as in the folders before it, where runs are the same",
           fmt::format("another result at point {}, seed {}", key.first, key.second));
  }
}

/// Drawings as SVG, and as PNG where the program that makes it is installed.
void WriteFigures(const std::vector<Figure>& figures, const fs::path& folder) {
  fs::remove_all(folder);
  if (figures.empty()) return;
  fs::create_directories(folder);
  const bool has_converter = !FindTool("rsvg-convert").empty();
  for (const Figure& figure : figures) {
    const fs::path svg = folder / (figure.name + ".svg");
    ReplaceFile(svg, figure.svg);
    if (!has_converter) continue;
    RunTool({"rsvg-convert", "--zoom", "2", "--background-color", "white", "--output",
             (folder / (figure.name + ".png")).string(), svg.string()},
            /*silent=*/true);
  }
}

std::string FailedGates(const std::vector<GateResult>& gates) {
  constexpr int kMost = 20;
  std::string text;
  int n = 0;
  for (const GateResult& gate : gates) {
    if (!gate.pass && n++ < kMost) text += fmt::format("FAIL {}: {}\n", gate.name, gate.message);
  }
  return n <= kMost ? text : text + fmt::format("… and {} more\n", n - kMost);
}

}  // namespace

SweepFolder::SweepFolder(fs::path path, const Json& plan, const ProcessShare& share, bool resume)
    : path_(std::move(path)) {
  std::error_code error;
  fs::create_directories(path_, error);
  if (error || !fs::is_directory(path_)) {
    MustBe("--out", "a folder, or one that can be made", fmt::format("'{}'", path_.string()));
  }
  const Json shard = ShardJson(share);
  CheckContent(plan, shard, resume);
  Lock();
  fs::remove_all(path_ / "work");
  ReplaceFile(path_ / "plan.json", plan.dump(1) + "\n");
  ReplaceFile(path_ / "shard.json", shard.dump() + "\n");
  // Without lines that a kill cut off; what was invalid is tried again.
  RunRows rows = ReadJournal(journal());
  std::erase_if(rows, [](const auto& entry) { return !entry.second.valid(); });
  WriteJournal(journal(), rows);
}

SweepFolder::~SweepFolder() {
  std::error_code ignored;
  fs::remove_all(path_ / "work", ignored);
  if (lock_ >= 0) close(lock_);
}

void SweepFolder::CheckContent(const Json& plan, const Json& shard, bool resume) const {
  const std::string name = path_.string();
  if (IsEmpty(path_)) return;
  const Json there = ReadJsonFile(path_ / "plan.json");
  if (!there.is_object()) MustBe("--out", "empty, new, or the folder of a sweep", "'" + name + "'");
  if (!resume) {
    MustBe("--out", "empty or new, unless --resume is given", "a sweep in '" + name + "'");
  }
  const std::string difference = DifferenceOfPlans(plan, there);
  if (!difference.empty()) {
    MustBe("--out", "of the same sweep by the same build, for --resume",
           fmt::format("another '{}' in '{}'", difference, (path_ / "plan.json").string()));
  }
  if (const Json other = ReadJsonFile(path_ / "shard.json"); other != shard) {
    MustBe("--out", "of the same --shard, for --resume", other.dump());
  }
}

void SweepFolder::Lock() {
  // Workers inherit it: it is free when the last one is gone.
  lock_ = open((path_ / kLockFile).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  const auto end = std::chrono::steady_clock::now() + kLockTimeout;
  while (flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    if (lock_ < 0 || std::chrono::steady_clock::now() > end) {
      MustBe("--out", "a folder that no other sweep is writing", "'" + path_.string() + "'");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

MergedSweep MergeShards(const std::vector<std::string>& folders) {
  MergedSweep merged;
  for (const std::string& folder : folders) {
    StoredPlan stored = ReadPlan(fs::path(folder) / "plan.json");
    if (merged.stored.json.is_null()) merged.stored = std::move(stored);
    const std::string difference = DifferenceOfPlans(merged.stored.json, stored.json);
    if (!stored.json.is_null() && !difference.empty()) {
      MustBe(folder + "/plan.json", "of the same sweep as " + folders.front(),
             fmt::format("another '{}'", difference));
    }
    AddShard(folder, &merged.rows);
  }
  const SweepPlan& plan = merged.stored.plan;
  for (std::size_t point = 0; point < plan.points.size(); ++point) {
    if (IsWhole(plan, merged.rows, static_cast<int>(point))) continue;
    MustBe("DIR", "all shards of the sweep, and those finished",
           fmt::format("not all runs of point {}: {}", point, plan.Describe(point)));
  }
  return merged;
}

int FinishSweep(const SweepPlan& plan, const RunRows& rows, const fs::path& folder) {
  const std::vector<PointSummary> points = SummarisePoints(plan, rows);
  const std::vector<GateResult> gates = EvaluateSweepGates(plan, points);
  const auto n_invalid =
      std::count_if(rows.begin(), rows.end(), [](auto& row) { return !row.second.valid(); });
  const auto n_failed = std::count_if(gates.begin(), gates.end(), [](auto& g) { return !g.pass; });
  const std::string invalid =
      n_invalid == 0 ? "" : fmt::format("{} of {} runs are INVALID", n_invalid, rows.size());
  ReplaceFile(folder / "table.csv", TableCsv(plan, rows));
  ReplaceFile(folder / "points.csv", PointsCsv(plan, points));
  ReplaceFile(folder / "junit.xml",
              JunitXml(plan.config.description, "every run is valid", invalid, gates));
  const SweepAnalysis analysis = AnalyseSweep(plan, points);
  const std::vector<Figure> figures = SweepFigures(plan, analysis);
  ReplaceFile(folder / "analysis.json", AnalysisJson(plan, analysis).dump(2) + "\n");
  ReplaceFile(folder / "report.html", SweepReport(plan, points, gates, analysis, figures));
  WriteFigures(figures, folder / "figures");
  fmt::print("{} points, {} runs, {} gates failed of {}\n", points.size(), rows.size(), n_failed,
             gates.size());
  std::cout << FailedGates(gates);
  fmt::print("table: {}\nreport: {}\n", (folder / "table.csv").string(),
             (folder / "report.html").string());
  if (n_invalid > 0) {
    for (const auto& [key, row] : rows) {
      if (row.valid()) continue;
      fmt::print(stderr, "windhover: error: point {}, seed {}: {}\n", row.point, row.seed,
                 row.reason);
    }
    return kRunInvalid;
  }
  return n_failed > 0 ? kGateFailed : kPass;
}

}  // namespace windhover
