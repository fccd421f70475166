#include <algorithm>
#include <iostream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "cli/command.h"
#include "cli/manifest.h"
#include "cli/progress.h"
#include "cli/sweep_cards.h"
#include "cli/sweep_folder.h"
#include "cli/sweep_run.h"
#include "cli/sweep_slurm.h"
#include "cli/tool.h"
#include "learn/estimator_check.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string file, out, shard;
  std::vector<std::string> folders;  ///< Of shards to merge.
  std::vector<std::string> slurm_options;
  std::string executor = "local";
  int jobs = 0;  ///< 0: as many as fit.
  int shards = 2;
  bool resume = false;
};

ProcessShare ShareOf(const Options& options) {
  if (options.shard.empty()) return {};
  const auto share = ShareFromText(options.shard);
  if (share) return *share;
  throw ConfigError(
      fmt::format("--shard: must be i/n with 0 <= i < n (found '{}')", options.shard));
}

/// What only the estimators' process would find wrong.
void CheckEstimatorsOf(const SweepPlan& plan) {
  const bool differ = std::any_of(plan.factors.begin(), plan.factors.end(), [](const Factor& f) {
    return f.key().starts_with("estimator.");
  });
  for (std::size_t i = 0; i < (differ ? plan.points.size() : 1); ++i) {
    CheckEstimators(plan.ScenarioAt(i).ForAircraft());
  }
}

/// As many workers as fit, in this machine.
bool RunHere(const Options& options, const SweepPlan& plan, const ProcessShare& share,
             const SweepFolder& folder) {
  PoolOptions pool{.journal = folder.journal(),
                   .jobs = options.jobs > 0 ? options.jobs : JobsThatFit(plan.ScenarioAt(0)),
                   .points = {},
                   .stop_requested = StopRequested};
  for (int i = 0; i < static_cast<int>(plan.points.size()); ++i) {
    if (share.Owns(i)) pool.points.push_back(i);
  }
  const int n_runs = static_cast<int>(pool.points.size()) * plan.config.seeds.count;
  Progress progress(isatty(STDERR_FILENO) != 0);
  pool.on_progress = [&](int done) {
    if (done > 0) progress.Update(std::min(done, n_runs), n_runs);
  };
  const SweepRunOptions run{
      .out = folder.path(), .metrics = plan.metrics, .keep = plan.config.keep};
  std::optional<SweepCards> cards;
  if (plan.config.retrain) cards.emplace(plan, folder.path());
  return RunPool(
      plan,
      [&](const Scenario& drawn, std::size_t point, const RunPlace& place) {
        return RunAndScore(cards ? cards->WithCard(drawn, point) : drawn, point, place, run);
      },
      pool);
}

/// As shards that Slurm spreads over machines; their runs come together in `folder`.
bool RunOnSlurm(const Options& options, const SweepPlan& plan, const SweepFolder& folder) {
  const SlurmJob job{.sweep_file = options.file,
                     .out = options.out,
                     .shards = std::min(options.shards, static_cast<int>(plan.points.size())),
                     .options = options.slurm_options};
  if (!RunSlurmJob(job)) return false;
  WriteJournal(folder.journal(), MergeShards(ShardFolders(job)).rows);
  return true;
}

void CheckOptions(const Options& options) {
  if (options.file.empty()) throw ConfigError("SWEEP: must be given (found nothing)");
  if (options.out.empty()) throw ConfigError("--out: must be given (found nothing)");
  if (options.executor == "slurm" && !options.shard.empty()) {
    throw ConfigError("--shard: must be left to --executor slurm, which gives each task its own");
  }
}

int Sweep(const Options& options) {
  CheckOptions(options);
  const bool on_slurm = options.executor == "slurm";
  const ProcessShare share = ShareOf(options);
  const SweepPlan plan = LoadSweepPlan(options.file);
  CheckRetraining(plan);
  CheckEstimatorsOf(plan);
  if (on_slurm && FindTool("sbatch").empty()) {
    fmt::print(stderr,
               "windhover: error: --executor slurm needs sbatch (apt install slurm-client)\n");
    return kEnvironmentMissing;
  }
  const SweepFolder folder(options.out, PlanJson(plan, BuildName()), share, options.resume);
  const bool is_whole =
      on_slurm ? RunOnSlurm(options, plan, folder) : RunHere(options, plan, share, folder);
  if (!is_whole) {
    fmt::print(stderr, "windhover: interrupted; the same command with --resume goes on\n");
    return kInterrupted;
  }
  return FinishSweep(plan, ReadJournal(folder.journal()), folder.path());
}

int Merge(const Options& options) {
  if (options.out.empty()) throw ConfigError("--out: must be given (found nothing)");
  const MergedSweep merged = MergeShards(options.folders);
  const SweepFolder folder(options.out, merged.stored.json, {}, /*resume=*/true);
  WriteJournal(folder.journal(), merged.rows);
  return FinishSweep(merged.stored.plan, merged.rows, folder.path());
}

}  // namespace

void AddSweepCommand(CLI::App& app, CommandAction* chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("sweep", "many runs, one table: what a scenario's keys do");
  command->add_option("SWEEP", options->file, "sweep file");
  command->add_option("--out", options->out, "folder of the sweep");
  command->add_option("--jobs", options->jobs, "runs side by side; default: as many as fit")
      ->check(CLI::Range(1, 256));
  command->add_option("--shard", options->shard, "i/n: every n-th point, from the i-th, from 0");
  command->add_option("--executor", options->executor, "where: on this machine, or by Slurm")
      ->check(CLI::IsMember({"local", "slurm"}));
  command->add_option("--shards", options->shards, "slurm: tasks of the job array; default 2")
      ->check(CLI::Range(1, kMaxPoints));
  command
      ->add_option("--slurm-option", options->slurm_options,
                   "slurm: an option for sbatch, as --partition=long; repeatable")
      ->allow_extra_args(false);
  command->add_flag("--resume", options->resume, "go on where a sweep was stopped");
  command->footer(
      "Example: windhover sweep scenarios/sweeps/vibration_x_focal.yaml --out sweeps/vibration");
  CLI::App* merge = command->add_subcommand("merge", "shards of one sweep into one table");
  merge->add_option("DIR", options->folders, "folders of all its shards")->required();
  merge->add_option("--out", options->out, "folder of the whole sweep")->required();
  merge->footer("Example: windhover sweep merge shards/0 shards/1 --out sweeps/vibration");
  command->callback([=] {
    *chosen = [=] { return options->folders.empty() ? Sweep(*options) : Merge(*options); };
  });
}

}  // namespace windhover
