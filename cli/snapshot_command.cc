#include <cstdlib>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/command.h"
#include "cli/process_run.h"
#include "cli/tool.h"
#include "common/file/whole_file.h"
#include "scenarios/scenario.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

struct SnapshotOptions {
  std::string file;
  std::vector<std::string> overrides;
  double time_s = 0;
  std::string out;
  bool dense = false;
};

int Snapshot(const SnapshotOptions& options) {
  const Scenario scenario = LoadScenario(options.file, options.overrides);
  if (!(options.time_s >= 0 && options.time_s <= scenario.duration_s)) {
    throw ConfigError(fmt::format("--time must be between 0 and duration_s, {} (found '{}')",
                                  scenario.duration_s, options.time_s));
  }
  fs::create_directories(options.out);
  const fs::path resolved = fs::path(options.out) / "resolved.yaml";
  ReplaceFile(resolved, ResolvedYaml(scenario, PathStyle::kAbsolute));
  // sim knows where everything is at that time, render what it looks like.
  const std::string truth = (fs::path(options.out) / "truth.bin").string();
  const std::string time_s = fmt::format("{}", options.time_s);
  int status = RunTool(
      {ProgramFolder() / "windhover-sim", resolved.string(), "--truth-at", time_s, "--out", truth});
  if (status == 0) {
    std::vector<std::string> render = {ProgramFolder() / "windhover-render",
                                       "--snapshot",
                                       resolved.string(),
                                       "--time",
                                       time_s,
                                       "--truth",
                                       truth,
                                       "--out",
                                       options.out};
    if (options.dense) render.push_back("--dense");
    status = RunTool(render);
  }
  fs::remove(truth);
  if (status != 0) return status;
  fmt::print("{}\n", options.out);
  return kPass;
}

}  // namespace

void AddSnapshotCommand(CLI::App& app, CommandAction* chosen) {
  auto options = std::make_shared<SnapshotOptions>();
  CLI::App* command =
      app.add_subcommand("snapshot", "left.png, right.png and labels.json of one instant");
  command->add_option("SCENARIO", options->file, "scenario file")->required();
  command->add_option("--time", options->time_s, "simulated time, s")->required();
  command->add_option("--out", options->out, "folder to write to")->required();
  command->add_option("--set", options->overrides, "a.b.c=value, as for run")
      ->allow_extra_args(false);
  command->add_flag("--dense", options->dense,
                    "also depth_*.tiff (m), disparity.tiff (px) and mask_*.png");
  command->footer("Example: windhover snapshot scenarios/uavde_12mm.yaml --time 5 --out shot");
  command->callback([=] { *chosen = [=] { return Snapshot(*options); }; });
}

}  // namespace windhover
