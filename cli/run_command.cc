#include <iostream>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "cli/command.h"
#include "cli/in_process_run.h"
#include "cli/manifest.h"
#include "cli/process_run.h"
#include "cli/run_directory.h"
#include "cli/verdict.h"
#include "common/file/whole_file.h"
#include "eval/evaluation.h"
#include "learn/estimator_check.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> Overrides(const RunOptions& options) {
  std::vector<std::string> overrides = options.overrides;
  if (!options.observe.empty()) overrides.push_back("observe=" + options.observe);
  if (options.seed) overrides.push_back(fmt::format("random_seed={}", *options.seed));
  if (!options.estimator.empty()) overrides.emplace_back("execution.estimator_processes=1");
  return overrides;
}

void TakeOptions(const RunOptions& options) {
  if (options.frames == "shm" && options.in_process) {
    throw ConfigError("--frames must be lcm with --in-process: no frame travels (found 'shm')");
  }
  const bool is_url = options.bus.find("://") != std::string::npos;
  if (!options.bus.empty() && options.bus != "tcpq" && options.bus != "udpm" && !is_url) {
    throw ConfigError(
        fmt::format("--bus must be tcpq, udpm or the URL of an LCM provider "
                    "(found '{}')",
                    options.bus));
  }
  if (options.in_process && !options.estimator.empty()) {
    throw ConfigError("--in-process must come without --estimator: that is a process of its own");
  }
  if (options.in_process && !options.bus.empty()) {
    throw ConfigError("--in-process must come without --bus: it needs none");
  }
  if ((options.isa == "avx2" && !__builtin_cpu_supports("avx2")) ||
      (options.isa == "avx512" && !__builtin_cpu_supports("avx512f"))) {
    throw ConfigError(fmt::format("--isa must be what this CPU has (found '{}')", options.isa));
  }
  // Before any loop asks, in this process or in those it starts.
  if (!options.isa.empty()) setenv("WINDHOVER_ISA", options.isa.c_str(), /*overwrite=*/1);
}

// Without images one process does all, unless a bus is asked for.
bool UsesOneProcess(const Scenario& scenario, const RunOptions& options) {
  const bool has_images =
      scenario.observe == Observe::kImage || scenario.observe == Observe::kAnnotated;
  return options.in_process || (!has_images && options.bus.empty() && options.estimator.empty());
}

void WriteJson(const fs::path& file, const nlohmann::ordered_json& json) {
  ReplaceFile(file, json.dump(2) + "\n");
}

// Scores what there is of the log, also of a run that died.
int Finish(const RunSummary& summary, const fs::path& run_dir, const RunOptions& options) {
  std::string verdict = "invalid";
  try {
    const Evaluation evaluation = Evaluate(run_dir);
    WriteScoreFiles(evaluation, run_dir);
    if (!options.no_report) WriteReport(evaluation, run_dir);
    std::cout << (options.as_json ? evaluation.score.dump(2) + "\n"
                                  : "\n" + VerdictTable(evaluation.score));
    verdict = evaluation.verdict;
  } catch (const std::exception& error) {
    if (summary.valid) throw;
    WriteJunitOfDeadRun(fmt::format("{}: {}", summary.culprit, summary.reason), run_dir);
    fmt::print(stderr, "windhover: nothing to score: {}\n", error.what());
  }
  if (!options.as_json) {
    std::cout << "run: " << run_dir.string() << '\n';
    if (!options.no_report) std::cout << "report: " << (run_dir / "report.html").string() << '\n';
  }
  if (summary.interrupted) return kInterrupted;
  if (summary.valid) return ExitCodeOf(verdict);
  fmt::print(stderr, "windhover: error: run invalid: {}: {}\n", summary.culprit, summary.reason);
  return kRunInvalid;
}

int Run(RunOptions options) {
  TakeOptions(options);
  const Scenario scenario = LoadScenario(options.scenario_file, Overrides(options));
  CheckEstimators(scenario.ForAircraft());
  const fs::path run_dir = MakeRunDirectory(options.scenario_file, options.out);
  ReplaceFile(run_dir / "resolved.yaml", ResolvedYaml(scenario, PathStyle::kAbsolute));
  WriteJunitOfDeadRun("did not finish", run_dir);
  options.in_process = UsesOneProcess(scenario, options);
  const RunSummary summary = options.in_process ? RunInOneProcess(scenario, run_dir, options)
                                                : RunProcesses(scenario, run_dir, options);
  WriteJson(run_dir / "timing.json", Timing(scenario, summary));
  WriteJson(run_dir / "manifest.json", Manifest(scenario, options, summary, run_dir));
  return Finish(summary, run_dir, options);
}

void AddOptions(CLI::App* command, RunOptions* o) {
  command->add_option("SCENARIO", o->scenario_file, "scenario file")->required();
  command->add_option("--out", o->out, "folder of the run; default runs/<name>-<n>");
  command->add_option("--seed", o->seed, "seed of every random stream");
  command->add_option("--set", o->overrides, "a.b.c=value: set a key of the scenario; repeatable")
      ->allow_extra_args(false);
  command->add_option("--bus", o->bus, "tcpq (default), udpm, or the URL of an LCM provider");
  command->add_option("--estimator", o->estimator,
                      "command of another estimator, which is given the arguments of ours");
  command->add_option("--observe", o->observe, "what the estimator gets of each frame")
      ->check(CLI::IsMember({"truth", "geometric", "annotated", "image"}));
  command->add_option("--record", o->record, "which pixels the log keeps")
      ->check(CLI::IsMember({"none", "jpeg", "raw"}));
  command->add_flag("--in-process", o->in_process,
                    "all in this process; default for observe truth and geometric");
  command->add_option("--threads", o->threads, "threads of each process")
      ->check(CLI::Range(1, 1024));
  command->add_option("--isa", o->isa, "no wider vector instructions than these; the same bits")
      ->check(CLI::IsMember({"avx2", "avx512"}));
  command
      ->add_option("--frames", o->frames,
                   "how pixels travel: in messages, or through shared memory")
      ->check(CLI::IsMember({"lcm", "shm"}));
  command->add_flag("--preview", o->preview, "also publish IMAGE_LEFT_<id> and IMAGE_RIGHT_<id>");
  command->add_flag("--realtime", o->realtime, "no faster than real time");
  command->add_flag("--no-report", o->no_report, "write no report.html");
  command->add_flag("--json", o->as_json, "print score.json instead of a table");
}

}  // namespace

void AddRunCommand(CLI::App& app, CommandAction* chosen) {
  auto options = std::make_shared<RunOptions>();
  options->threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  CLI::App* command =
      app.add_subcommand("run", "runs a scenario, scores it, reports; exit code is the verdict");
  AddOptions(command, options.get());
  command->footer(
      "Example: windhover run scenarios/ideal_geometric.yaml --seed 3 --set duration_s=2");
  command->callback([=] { *chosen = [=] { return Run(*options); }; });
}

}  // namespace windhover
