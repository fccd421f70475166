#include <algorithm>
#include <fstream>
#include <iostream>
#include <map>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/command.h"
#include "cli/verdict.h"
#include "common/config/fields.h"
#include "eval/comparison.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Options {
  std::vector<std::string> runs;
  std::string baseline;
  std::vector<std::string> max_worse;
  bool as_json = false;
};

[[noreturn]] void MustBe(const std::string& where, const std::string& must,
                         const std::string& found) {
  throw ConfigError(fmt::format("{}: must be {} (found {})", where, must, found));
}

struct KnownRun {
  fs::path log;
  Evaluation evaluation;
};

/// A folder or log of one run, or the runs in a folder, each of a seed of its own. Of several only
/// scenario and score are kept.
std::map<std::uint64_t, KnownRun> RunsIn(const fs::path& source) {
  std::vector<fs::path> logs;
  if (!fs::is_directory(source) || fs::exists(source / "run.lcm")) {
    logs.push_back(source);
  } else {
    for (const auto& entry : fs::directory_iterator(source)) {
      if (fs::exists(entry.path() / "run.lcm")) logs.push_back(entry.path());
    }
  }
  if (logs.empty()) MustBe(source.string(), "a run, or a folder of runs", "no run.lcm");
  std::sort(logs.begin(), logs.end());
  std::map<std::uint64_t, KnownRun> runs;
  for (const fs::path& log : logs) {
    Evaluation evaluation = Evaluate(log);
    if (logs.size() > 1) {
      evaluation.targets = {};
      evaluation.run.frames.clear();
      evaluation.run.world.clear();
      evaluation.run.commands.clear();
    }
    const std::uint64_t seed = evaluation.run.scenario.random_seed;
    const auto [known, is_new] = runs.try_emplace(seed, KnownRun{log, std::move(evaluation)});
    if (!is_new) {
      MustBe(log.string(), "of another seed than the rest",
             fmt::format("seed {}, as {}", seed, known->second.log.string()));
    }
  }
  return runs;
}

/// What was found in all pairs of runs.
struct Comparison {
  std::vector<MetricDifference> runs, frames;  ///< Of frames only if there is one pair.
  std::vector<std::string> different_keys;     ///< Of the first pair.
  int n_pairs = 0, n_invalid = 0;
};

Comparison Compare(const std::map<std::uint64_t, KnownRun>& in_a,
                   const std::map<std::uint64_t, KnownRun>& in_b) {
  Comparison comparison;
  std::vector<Json> a, b;
  const bool is_single = in_a.size() == 1 && in_b.size() == 1;  // Of whatever seeds.
  for (const auto& [seed, run] : in_a) {
    const auto other = is_single ? in_b.begin() : in_b.find(seed);
    if (other == in_b.end()) continue;
    const Evaluation &one = run.evaluation, &two = other->second.evaluation;
    if (a.empty()) comparison.different_keys = DifferentKeys(one.run.scenario, two.run.scenario);
    if (is_single) comparison.frames = CompareFrames(one, two);
    comparison.n_invalid += (one.run.valid ? 0 : 1) + (two.run.valid ? 0 : 1);
    a.push_back(one.score);
    b.push_back(two.score);
  }
  comparison.n_pairs = static_cast<int>(a.size());
  comparison.runs = CompareScores(a, b);
  return comparison;
}

std::string Row(const MetricDifference& difference) {
  std::string interval = "-";
  if (difference.ci95) {
    interval = fmt::format("[{:+.4g}, {:+.4g}]", (*difference.ci95)[0], (*difference.ci95)[1]);
  }
  return fmt::format("{:<38} {:>6} {:>10.4g} {:>10.4g} {:>+10.4g}  {}\n", difference.metric,
                     difference.n, difference.a, difference.b, difference.Difference(), interval);
}

// The groups of methods by distance are for programs: --json.
bool IsForPeople(const std::string& metric) {
  return metric.starts_with("swarm.") || std::count(metric.begin(), metric.end(), '.') == 2;
}

void PrintTable(const Comparison& comparison) {
  for (const std::string& key : comparison.different_keys) fmt::print("{}\n", key);
  const auto header = [](const char* what, const char* n) {
    fmt::print("\n{:<38} {:>6} {:>10} {:>10} {:>10}  {}\n", what, n, "A", "B", "B - A", "95 %");
  };
  if (!comparison.frames.empty()) {
    header("on the frames that both have", "frames");
    for (const MetricDifference& one : comparison.frames) std::cout << Row(one);
  }
  header("metric", "runs");
  for (const MetricDifference& one : comparison.runs) {
    if (IsForPeople(one.metric)) std::cout << Row(one);
  }
  if (comparison.n_invalid > 0) fmt::print("\nINVALID: {} of the runs\n", comparison.n_invalid);
}

Json ToJson(const std::vector<MetricDifference>& differences) {
  Json list = Json::array();
  for (const MetricDifference& one : differences) {
    Json json = {{"metric", one.metric},
                 {"n", one.n},
                 {"a", one.a},
                 {"b", one.b},
                 {"difference", one.Difference()}};
    json["ci95"] = one.ci95 ? Json(*one.ci95) : Json(nullptr);
    list.push_back(std::move(json));
  }
  return list;
}

int CompareRuns(const Options& options) {
  if (options.runs.size() != 2) {
    MustBe("RUN", "two: A and B", fmt::format("{}", options.runs.size()));
  }
  const Comparison comparison = Compare(RunsIn(options.runs[0]), RunsIn(options.runs[1]));
  if (comparison.n_pairs == 0) MustBe(options.runs[1], "runs of seeds that A has", "none");
  if (options.as_json) {
    std::cout << Json{{"pairs", comparison.n_pairs},
                      {"invalid", comparison.n_invalid},
                      {"different_keys", comparison.different_keys},
                      {"frames", ToJson(comparison.frames)},
                      {"runs", ToJson(comparison.runs)}}
                     .dump(2)
              << '\n';
  } else {
    PrintTable(comparison);
  }
  return comparison.n_invalid > 0 ? kRunInvalid : kPass;
}

std::vector<AllowedLoss> AllowedLosses(const std::vector<std::string>& texts) {
  std::vector<AllowedLoss> allowed;
  std::string problems;
  for (const std::string& text : texts) {
    const std::size_t at = text.find('=');
    AllowedLoss& one = allowed.emplace_back();
    one.metric = text.substr(0, at);
    const bool is_good = at != std::string::npos && at > 0 &&
                         CLI::detail::lexical_cast(text.substr(at + 1), one.most) && one.most >= 0;
    if (!is_good) {
      problems += fmt::format("{}--max-worse: must be METRIC=LOSS of at least 0 (found '{}')",
                              problems.empty() ? "" : "\n", text);
    }
  }
  if (allowed.empty()) problems = "--max-worse: must be given with --baseline (found none)";
  if (!problems.empty()) throw ConfigError(problems);
  return allowed;
}

Json ReadScore(const fs::path& file) {
  std::ifstream in(file);
  Json score = Json::parse(in, nullptr, /*allow_exceptions=*/false);
  if (!score.is_object() || !score.contains("methods")) {
    MustBe(file.string(), "a score.json", score.is_discarded() ? "no JSON" : "other JSON");
  }
  return score;
}

Json ToJson(const Regression& one) {
  const auto number = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
  };
  return {{"metric", one.allowed.metric}, {"baseline", number(one.before)},
          {"run", number(one.now)},       {"loss", one.loss},
          {"allowed", one.allowed.most},  {"pass", one.pass},
          {"message", one.message}};
}

int CompareWithBaseline(const Options& options) {
  if (options.runs.size() != 1) {
    MustBe("RUN", "one, with --baseline", fmt::format("{}", options.runs.size()));
  }
  const auto allowed = AllowedLosses(options.max_worse);
  const Json baseline = ReadScore(options.baseline);
  const Evaluation run = Evaluate(options.runs[0]);
  const auto regressions = FindRegressions(baseline, run.score, allowed);
  bool passes = true;
  Json list = Json::array();
  for (const Regression& one : regressions) {
    passes = passes && one.pass;
    list.push_back(ToJson(one));
    if (options.as_json) continue;
    fmt::print("{:<4} {:<38} {:>10} → {:>10}  {}\n", one.pass ? "pass" : "FAIL", one.allowed.metric,
               one.before ? fmt::format("{:.4g}", *one.before) : "-",
               one.now ? fmt::format("{:.4g}", *one.now) : "-", one.message);
  }
  if (options.as_json) std::cout << list.dump(2) << '\n';
  if (!run.run.valid) {
    fmt::print(stderr, "windhover: error: the run is INVALID: {}\n", run.run.invalid_reason);
    return kRunInvalid;
  }
  return passes ? kPass : kGateFailed;
}

}  // namespace

void AddCompareCommand(CLI::App& app, CommandAction* chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "compare", "two runs, or two folders of runs of the same seeds, side by side");
  command
      ->add_option("RUN", options->runs,
                   "A and B: run directories, logs, or folders of runs; one with --baseline")
      ->required()
      ->check(CLI::ExistingPath);
  command->add_option("--baseline", options->baseline, "score.json to hold RUN against")
      ->check(CLI::ExistingFile);
  command->add_option("--max-worse", options->max_worse,
                      "METRIC=LOSS: fails (exit 1) if a metric is worse than that; repeatable");
  command->add_flag("--json", options->as_json, "print JSON instead of a table");
  command->footer(
      "Example: windhover compare runs/vibration_0 runs/vibration_3\n"
      "         windhover compare --baseline main/score.json runs/now --max-worse "
      "methods.fused.abs_rel=0.01");
  command->callback([=] {
    *chosen = [=] {
      return options->baseline.empty() ? CompareRuns(*options) : CompareWithBaseline(*options);
    };
  });
}

}  // namespace windhover
