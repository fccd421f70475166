#include <cstdlib>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/command.h"
#include "cli/process_run.h"
#include "cli/tool.h"

namespace windhover {
namespace {

struct BenchOptions {
  std::string rasteriser = "osmesa";
  std::string instructions;
  int threads = 1;
  int rounds = 10;
  bool as_json = false;
};

int BenchRender(const BenchOptions& options) {
  if (!options.instructions.empty()) {
    setenv("WINDHOVER_ISA", options.instructions.c_str(), /*overwrite=*/1);
  }
  std::vector<std::string> words = {ProgramFolder() / "windhover-render",
                                    "--benchmark",
                                    "--rasteriser",
                                    options.rasteriser,
                                    "--threads",
                                    fmt::format("{}", options.threads),
                                    "--rounds",
                                    fmt::format("{}", options.rounds)};
  if (options.as_json) words.push_back("--json");
  return RunTool(words);
}

}  // namespace

void AddBenchCommand(CLI::App& app, CommandAction* chosen) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* bench = app.add_subcommand("bench", "what parts of a run cost on this machine");
  bench->require_subcommand(1);
  bench->footer("Example: windhover bench render");
  CLI::App* render = bench->add_subcommand("render", "CPU time of a stereo pair");
  render->add_flag("--json", options->as_json, "print JSON instead of a table");
  render->add_option("--rasteriser", options->rasteriser, "who draws aircraft")
      ->check(CLI::IsMember({"osmesa", "native"}));
  render->add_option("--isa", options->instructions, "no wider instructions than these")
      ->check(CLI::IsMember({"sse2", "avx2", "avx512"}));
  render->add_option("--threads", options->threads, "of each process")->check(CLI::Range(1, 1024));
  render->add_option("--rounds", options->rounds, "of which the least counts")
      ->check(CLI::Range(1, 10000));
  render->footer("Example: windhover bench render --json");
  render->callback([=] { *chosen = [=] { return BenchRender(*options); }; });
}

}  // namespace windhover
