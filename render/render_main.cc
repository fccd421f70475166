#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <malloc.h>

#include "common/process/process.h"
#include "render/dense_labels.h"
#include "render/mesh_info.h"
#include "render/render_benchmark.h"
#include "render/render_node.h"
#include "render/self_test.h"
#include "render/snapshot.h"

namespace windhover {
namespace {

constexpr char kName[] = "windhover-render";
constexpr char kPurpose[] = "renders what the stereo rig of each aircraft sees";
constexpr int kEnvironmentMissing = 4;

void RunNode(const ProcessArgs& args) {
  // Threads come and go with each part of a frame. A heap for each kept 30 MiB that others needed.
  mallopt(M_ARENA_MAX, 1);
  const Scenario scenario = LoadScenario(args.scenario_file);
  Bus bus(args.url);
  TickClient client(bus, fmt::format("render-{}", args.share.index), args.run_id);
  const RenderNodeOptions options{
      .preview = args.preview,
      .shares_frames = args.shares_frames,
      .frames_dir = args.run_dir.empty() ? "" : std::filesystem::path(args.run_dir) / "frames"};
  RenderNode node(scenario, args.share, args.threads, client, options);
  while (!client.Ended() && !StopRequested()) {
    client.Announce();
    bus.Handle(/*timeout_ms=*/100);
  }
}

int RunSnapshot(int argc, char** argv) {
  std::string scenario_file, truth_file, out = ".";
  std::vector<std::string> overrides;
  double t_s = 0;
  int threads = 1;
  bool dense = false;
  CLI::App app("renders one instant: left.png, right.png, labels.json", kName);
  app.add_option("--snapshot", scenario_file, "scenario")->required();
  app.add_option("--time", t_s, "simulated time, s")->check(CLI::Range(0.0, 1e6));
  app.add_option("--truth", truth_file, "encoded world_truth_t; default: the start positions");
  app.add_option("--out", out, "folder to write to");
  app.add_option("--set", overrides, "overrides: a.b.c=value");
  app.add_option("--threads", threads, "threads to work with")->check(CLI::Range(1, 1024));
  app.add_flag("--dense", dense, "also write depth, disparity and masks, pixel by pixel");
  return RunProgram(app, argc, argv, [&] {
    const Scenario scenario = LoadScenario(scenario_file, overrides);
    const world_truth_t world =
        truth_file.empty() ? StartWorld(scenario, t_s) : ReadWorld(truth_file);
    WriteSnapshot(scenario, world, threads, out);
    if (dense) {
      WriteDenseLabels(MakeDenseLabels(scenario, OwnedObservers(scenario, {}).front(), world), out);
    }
  });
}

int RunBenchmark(int argc, char** argv) {
  RenderBenchmarkPlan plan;
  bool as_json = false;
  const std::map<std::string, Rasteriser> rasterisers = {{"osmesa", Rasteriser::kOsMesa},
                                                         {"native", Rasteriser::kNative}};
  CLI::App app("times stereo pairs", kName);
  app.add_flag_function(
         "--benchmark", [](std::int64_t) {}, "time stereo pairs")
      ->required();
  app.add_flag("--json", as_json, "print JSON instead of a table");
  app.add_option("--rasteriser", plan.rasteriser, "who draws aircraft")
      ->transform(CLI::CheckedTransformer(rasterisers));
  app.add_option("--threads", plan.threads, "of each process")->check(CLI::Range(1, 1024));
  app.add_option("--rounds", plan.rounds, "of which the least counts")->check(CLI::Range(1, 10000));
  return RunProgram(app, argc, argv, [&] {
    const nlohmann::ordered_json result = RunRenderBenchmark(plan);
    fmt::print("{}", as_json ? result.dump(2) + "\n" : RenderBenchmarkText(result));
  });
}

// Speaks in the name of the command that a person has typed.
int RunMeshInfo(int argc, char** argv) {
  std::string file;
  bool as_json = false;
  CLI::App app("what a mesh file holds", "windhover");
  app.add_option("--mesh-info", file, "mesh file")->required();
  app.add_flag("--json", as_json, "print JSON");
  return RunProgram(app, argc, argv, [&] {
    const nlohmann::ordered_json info = MeshInfo(file);
    fmt::print("{}", as_json ? info.dump(2) + "\n" : MeshInfoText(info));
  });
}

int RunSelfTest() {
  try {
    fmt::print("{}\n", RunGlSelfTest());
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: error: {}\n", kName, error.what());
    return kEnvironmentMissing;
  }
}

bool HasFlag(int argc, char** argv, std::string_view flag) {
  return std::any_of(argv + 1, argv + argc, [flag](const char* argument) {
    return std::string_view(argument).substr(0, flag.size()) == flag;
  });
}

}  // namespace
}  // namespace windhover

int main(int argc, char** argv) {
  if (windhover::HasFlag(argc, argv, "--self-test")) return windhover::RunSelfTest();
  if (windhover::HasFlag(argc, argv, "--benchmark")) return windhover::RunBenchmark(argc, argv);
  if (windhover::HasFlag(argc, argv, "--mesh-info")) return windhover::RunMeshInfo(argc, argv);
  if (windhover::HasFlag(argc, argv, "--snapshot")) return windhover::RunSnapshot(argc, argv);
  return windhover::RunProcess(windhover::kName, windhover::kPurpose, argc, argv,
                               windhover::RunNode);
}
