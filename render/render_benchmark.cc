#include "render/render_benchmark.h"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <vector>

#include <fmt/format.h>
#include <time.h>

#include "common/cpu/instruction_set.h"
#include "common/process/process.h"
#include "render/benchmark_scene.h"
#include "render/benchmark_worker.h"
#include "render/motion.h"
#include "render/scene_geometry.h"

namespace windhover {
namespace {

using nlohmann::ordered_json;
using PoseTimes = std::array<Times, kBenchmarkPoses>;

constexpr double kPairs = kBenchmarkPoses;

// Loading the program and its libraries, which a forked process is spared.
double LoadingTime_s() {
  timespec cpu{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu);
  return static_cast<double>(cpu.tv_sec) + 1e-9 * static_cast<double>(cpu.tv_nsec);
}

double Sum(const PoseTimes& times, double Times::*part) {
  return std::accumulate(times.begin(), times.end(), 0.0,
                         [part](double sum, const Times& t) { return sum + t.*part; });
}

// The least CPU and the least wall time of whole rounds, and what was spent on each pose in the
// round of least CPU time.
struct Row {
  double cpu_s = 1e9, wall_s = 1e9;
  PoseTimes of_pose{};

  void Add(const PoseTimes& round) {
    wall_s = std::min(wall_s, Sum(round, &Times::wall_s));
    if (Sum(round, &Times::cpu_s) >= cpu_s) return;
    cpu_s = Sum(round, &Times::cpu_s);
    of_pose = round;
  }
};

struct Rows {
  Row background, full, blurred;
  double two_cpu_s = 1e9;   ///< Of both processes.
  double two_wall_s = 1e9;  ///< From the start of both to the end of both.
};

struct Workers {
  Workers(const Scenario& sharp, const Scenario& blur, int threads)
      : full(sharp, threads, BenchmarkWorld),
        other(sharp, threads, BenchmarkWorld),
        blurred(blur, threads, BlurredBenchmarkWorld),
        background(sharp, threads, [](int) { return EmptyBenchmarkWorld(); }) {}

  BenchmarkWorker full, other, blurred, background;
};

PoseTimes RoundOf(BenchmarkWorker* worker) {
  worker->StartRound();
  return worker->EndRound();
}

void RoundOfBoth(Workers* workers, Rows* rows) {
  const auto start = std::chrono::steady_clock::now();
  workers->full.StartRound();
  workers->other.StartRound();
  const PoseTimes first = workers->full.EndRound(), second = workers->other.EndRound();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  rows->two_wall_s = std::min(rows->two_wall_s, wall.count());
  rows->two_cpu_s =
      std::min(rows->two_cpu_s, Sum(first, &Times::cpu_s) + Sum(second, &Times::cpu_s));
}

Rows Measure(Workers* workers, int rounds) {
  Rows rows;
  for (int i = 0; i < rounds && !StopRequested(); ++i) {
    rows.background.Add(RoundOf(&workers->background));
    rows.full.Add(RoundOf(&workers->full));
    rows.blurred.Add(RoundOf(&workers->blurred));
    RoundOfBoth(workers, &rows);
  }
  return rows;
}

ordered_json JsonFrom(const Row& row, BenchmarkWorker* worker) {
  return {{"cpu_ms", 1e3 * row.cpu_s / kPairs},
          {"wall_ms", 1e3 * row.wall_s / kPairs},
          {"pairs_per_s", kPairs / row.wall_s},
          {"peak_memory_mib", worker->PeakMemory_MiB()}};
}

int PartsOfBlurredExposure(const Scenario& scenario) {
  const SceneGeometry geometry(scenario, {0});
  return static_cast<int>(PlanExposure(scenario.exposure, scenario.exposure.duration_ms * 1e-3,
                                       BlurredBenchmarkWorld(0), 0, geometry.Observers()[0].motion,
                                       scenario.rig.calibrated.FocalPx())
                              .offsets_s.size());
}

std::string NameOf(InstructionSet set) {
  return set == InstructionSet::kAvx512 ? "avx512" : set == InstructionSet::kAvx2 ? "avx2" : "sse2";
}

ordered_json Setting(const RenderBenchmarkPlan& plan, const Scenario& scenario) {
  const SceneGeometry geometry(scenario, {0});
  const AircraftModel& model = geometry.ShapeOf(1).model;
  return {{"poses", kBenchmarkPoses},
          {"distances_m", {kNearestBenchmarkPose_m, kFarthestBenchmarkPose_m}},
          {"image_px", scenario.rig.calibrated.image},
          {"target_triangles", model.body.triangles.size() + model.rotor_discs.triangles.size()},
          {"rasteriser", plan.rasteriser == Rasteriser::kNative ? "native" : "osmesa"},
          {"instructions", NameOf(WidestInstructionSet())},
          {"threads", plan.threads},
          {"rounds", plan.rounds}};
}

}  // namespace

nlohmann::ordered_json RunRenderBenchmark(const RenderBenchmarkPlan& plan) {
  const double loading_s = LoadingTime_s();
  Scenario sharp = BenchmarkScenario(), blur = BlurredBenchmarkScenario();
  sharp.render.rasteriser = blur.render.rasteriser = plan.rasteriser;
  Workers workers(sharp, blur, plan.threads);
  const Rows rows = Measure(&workers, plan.rounds);
  ordered_json result = {{"setting", Setting(plan, sharp)},
                         {"background", JsonFrom(rows.background, &workers.background)},
                         {"full", JsonFrom(rows.full, &workers.full)},
                         {"blurred", JsonFrom(rows.blurred, &workers.blurred)}};
  for (int i = 0; i < kBenchmarkPoses; ++i) {
    result["full"]["by_pose"].push_back(
        {{"distance_m", BenchmarkPoseAt(i).p_WB_m[0]},
         {"cpu_ms", 1e3 * rows.full.of_pose[static_cast<std::size_t>(i)].cpu_s}});
  }
  result["blurred"]["time_samples"] = PartsOfBlurredExposure(blur);
  result["blurred"]["ratio"] = rows.blurred.cpu_s / rows.full.cpu_s;
  result["two_processes"] = {{"cpu_ms", 1e3 * rows.two_cpu_s / (2 * kPairs)},
                             {"pairs_per_s", 2 * kPairs / rows.two_wall_s},
                             {"ratio", 2 * rows.full.wall_s / rows.two_wall_s}};
  const Times start_up = workers.full.StartUp();
  result["start_up"] = {{"cpu_s", start_up.cpu_s + loading_s},
                        {"wall_s", start_up.wall_s + loading_s}};
  return result;
}

std::string RenderBenchmarkText(const nlohmann::ordered_json& result) {
  const ordered_json& setting = result["setting"];
  std::string text = fmt::format(
      "{} poses from {} to {} m, {}x{} px, distortion, anti-aliasing and noise on;\n"
      "target of {} triangles; rasteriser {}, {}, {} thread(s), least of {} rounds\n\n"
      "{:<32}{:>12}{:>12}{:>10}{:>10}\n",
      setting["poses"].get<int>(), setting["distances_m"][0].get<double>(),
      setting["distances_m"][1].get<double>(), setting["image_px"][0].get<int>(),
      setting["image_px"][1].get<int>(), setting["target_triangles"].get<int>(),
      setting["rasteriser"].get<std::string>(), setting["instructions"].get<std::string>(),
      setting["threads"].get<int>(), setting["rounds"].get<int>(), "a stereo pair", "CPU ms",
      "wall ms", "pairs/s", "peak MiB");
  const auto add = [&](const std::string& name, const ordered_json& row) {
    text += fmt::format("{:<32}{:>12.2f}{:>12.2f}{:>10.1f}{:>10.0f}\n", name,
                        row["cpu_ms"].get<double>(), row["wall_ms"].get<double>(),
                        row["pairs_per_s"].get<double>(), row["peak_memory_mib"].get<double>());
  };
  const ordered_json& blurred = result["blurred"];
  add("background and noise", result["background"]);
  add("full", result["full"]);
  add(fmt::format("full, {} time samples", blurred["time_samples"].get<int>()), blurred);
  const ordered_json& two = result["two_processes"];
  text += fmt::format("{:<32}{:>12.2f}{:>12}{:>10.1f}\n", "full, two processes",
                      two["cpu_ms"].get<double>(), "", two["pairs_per_s"].get<double>());
  text += fmt::format(
      "\nblur costs {:.2f} x; two processes give {:.2f} x; start-up {:.2f} s of CPU, {:.2f} s\n",
      blurred["ratio"].get<double>(), two["ratio"].get<double>(),
      result["start_up"]["cpu_s"].get<double>(), result["start_up"]["wall_s"].get<double>());
  return text;
}

}  // namespace windhover
