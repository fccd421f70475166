#include <iostream>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/command.h"
#include "cli/in_process_run_replay.h"
#include "cli/run_directory.h"
#include "cli/verdict.h"
#include "common/file/whole_file.h"
#include "eval/evaluation.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

struct ReplayArguments {
  std::string run;
  std::string estimator;
  std::string correction;
  std::string out;
  int threads = 1;
};

fs::path LogOf(const fs::path& run) { return fs::is_directory(run) ? run / "run.lcm" : run; }

// The scenario beside the log says where input files are; a bare log only what they are called.
Scenario ScenarioOf(const ReplayArguments& arguments, const fs::path& log) {
  const fs::path resolved = log.parent_path() / "resolved.yaml";
  Scenario scenario = fs::exists(resolved) ? LoadScenario(resolved) : ScenarioOfLog(log);
  if (!arguments.correction.empty()) {
    scenario.estimator.methods = {arguments.correction};
    scenario.estimator.in_loop = arguments.correction;
    const std::string text = ResolvedYaml(scenario, PathStyle::kAbsolute);
    return ScenarioFromYaml(text, "--correction");  // Reports an unknown name.
  }
  return scenario;
}

void PrintComparison(const ReplayResult& result) {
  if (result.n_different == 0) {
    fmt::print("replay: {} ticks, {} messages, all bits as recorded\n", result.n_ticks,
               result.n_events);
  } else {
    fmt::print("replay: {} ticks, {} of {} messages differ from the recording, first {}\n",
               result.n_ticks, result.n_different, result.n_events, result.first_difference);
  }
}

int RunReplay(const ReplayArguments& arguments) {
  const fs::path log = LogOf(arguments.run);
  if (!fs::exists(log)) {
    throw ConfigError(
        fmt::format("RUN must be a run directory or a log (found no '{}')", log.string()));
  }
  const Scenario scenario = ScenarioOf(arguments, log);
  const fs::path beside = log.parent_path() / "replay";
  const fs::path out =
      MakeRunDirectory("replay", arguments.out.empty() ? beside.string() : arguments.out);
  ReplaceFile(out / "resolved.yaml", ResolvedYaml(scenario, PathStyle::kAbsolute));
  const ReplayResult result =
      ReplayLog(scenario, {log, out, arguments.estimator, arguments.threads});
  const Evaluation evaluation = Evaluate(out);
  WriteScoreFiles(evaluation, out);
  std::cout << VerdictTable(evaluation.score) << "replay: " << out.string() << '\n';
  PrintComparison(result);
  const bool must_agree = arguments.estimator.empty() && arguments.correction.empty();
  return must_agree && result.n_different > 0 ? kGateFailed : kPass;
}

}  // namespace

void AddReplayCommand(CLI::App& app, CommandAction* chosen) {
  auto arguments = std::make_shared<ReplayArguments>();
  arguments->threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  CLI::App* command = app.add_subcommand("replay",
                                         "feeds a recorded flight to the estimator again; "
                                         "the same estimator gives the same bits");
  command->add_option("RUN", arguments->run, "run directory, or a log")->required();
  command->add_option("--estimator", arguments->estimator,
                      "command of another estimator, which is given the arguments of ours");
  command->add_option("--correction", arguments->correction,
                      "a method of estimator.methods to run instead of the recorded ones");
  command->add_option("--out", arguments->out, "folder of the replay; default RUN/replay");
  command->add_option("--threads", arguments->threads, "threads to work with")
      ->check(CLI::Range(1, 1024));
  command->footer("Example: windhover replay runs/ideal_geometric-1");
  command->callback([=] { *chosen = [=] { return RunReplay(*arguments); }; });
}

}  // namespace windhover
