// What a swarm costs without images: rings of 2 to 20 aircraft fly with boxes of `observe:
// geometric`, all nodes in one process, behind lenses that see few and many of the others. Prints
// CPU time of a tick against the pairs of aircraft and target in view, and draws it.
//
//     swarm_cost scenarios/flock_6.yaml docs/figures/cost_by_pairs.svg

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <vector>

#include <CLI/CLI.hpp>
#include <Eigen/Dense>
#include <fmt/format.h>
#include <unistd.h>

#include "cli/in_process_run.h"
#include "common/file/whole_file.h"
#include "eval/evaluation.h"
#include "eval/svg_chart.h"
#include "sim/world.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

constexpr double kDuration_s = 40, kRate_hz = 10, kSpacing_m = 6;
constexpr int kRounds = 5;

double CpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// `n` of the scenario's aircraft in a ring, each looking across it.
Scenario Ring(const std::string& file, int n, double focal_mm) {
  const double radius_m = kSpacing_m / 2 / std::sin(EIGEN_PI / n);
  Scenario scenario = LoadScenario(
      file, {"observe=geometric", "geometric.sigma_px=1", fmt::format("rig.focal_mm={}", focal_mm),
             fmt::format("duration_s={}", kDuration_s), fmt::format("frame_rate_hz={}", kRate_hz),
             // Those across are at the distance of balance.
             fmt::format("swarm.reynolds.cohesion_per_s={}", 9.6 / (4 * radius_m * radius_m))});
  const Aircraft one = scenario.aircraft.front();
  scenario.aircraft.clear();
  for (int i = 0; i < n; ++i) {
    const double angle_rad = 2 * EIGEN_PI * i / n;
    Aircraft& aircraft = scenario.aircraft.emplace_back(one);
    aircraft.self.id = i;
    aircraft.position_m = {radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad), 20};
    aircraft.yaw_deg = 360.0 * i / n - 180;
  }
  return scenario;
}

struct Cost {
  int n_aircraft;
  double seen;       ///< Pairs of aircraft and target in view of both its cameras, a tick.
  double cpu_ms;     ///< Of a tick.
  double real_time;  ///< Seconds flown in one of CPU.

  double Pairs() const { return n_aircraft * (n_aircraft - 1.0); }
};

Cost Measure(const std::string& file, int n, double focal_mm, const fs::path& folder) {
  const Scenario scenario = Ring(file, n, focal_mm);
  RunOptions options;
  options.quiet = true;
  const int n_ticks = NumberOfTicks(scenario);
  double least_s = 1e9;
  for (int round = 0; round < kRounds; ++round) {
    const double start_s = CpuSeconds();
    const RunSummary run = RunInOneProcess(scenario, folder, options);
    least_s = std::min(least_s, CpuSeconds() - start_s);
    if (!run.valid) throw std::runtime_error(run.culprit + ": " + run.reason);
  }
  const Evaluation evaluation = Evaluate(folder);
  return {n, static_cast<double>(evaluation.targets.frames.size()) / n_ticks,
          1e3 * least_s / n_ticks, kDuration_s / least_s};
}

/// CPU of a tick in ms as a + b aircraft + c pairs + d pairs in view, by least squares.
Eigen::Vector4d Fit(const std::vector<Cost>& costs) {
  Eigen::MatrixX4d known(costs.size(), 4);
  Eigen::VectorXd cpu_ms(costs.size());
  for (std::size_t k = 0; k < costs.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    known.row(row) << 1, costs[k].n_aircraft, costs[k].Pairs(), costs[k].seen;
    cpu_ms[row] = costs[k].cpu_ms;
  }
  return known.colPivHouseholderQr().solve(cpu_ms);
}

void Run(const std::string& file, const std::string& figure, const fs::path& folder) {
  Chart chart{.title = "Rings of 2 to 20 aircraft, boxes without pixels",
              .x_label = "pairs of an aircraft and another",
              .y_label = "CPU a tick, ms",
              .series = {}};
  std::vector<Cost> costs;
  fmt::print("| lens, mm | aircraft | pairs | in view | CPU a tick, ms | flown s in a CPU s |\n");
  for (const double focal_mm : {12.0, 3.0, 1.5}) {
    ChartSeries series{.name = {},
                       .style = ChartSeries::Style::kLineWithPoints,
                       .look = static_cast<int>(chart.series.size()),
                       .points = {}};
    for (int n = 2; n <= 20; n += 2) {
      const Cost& cost = costs.emplace_back(Measure(file, n, focal_mm, folder));
      series.points.push_back({cost.Pairs(), cost.cpu_ms});
      fmt::print("| {:g} | {} | {} | {:.1f} | {:.3f} | {:.0f} |\n", focal_mm, n, cost.Pairs(),
                 cost.seen, cost.cpu_ms, cost.real_time);
    }
    series.name = fmt::format("{:g} mm: {:.0f} % of 380 in view", focal_mm,
                              100 * costs.back().seen / costs.back().Pairs());
    chart.series.push_back(std::move(series));
  }
  const Eigen::Vector4d fit = 1e3 * Fit(costs);
  fmt::print("CPU a tick, us: {:.0f} + {:.1f} an aircraft + {:.2f} a pair + {:.2f} more in view\n",
             fit[0], fit[1], fit[2], fit[3]);
  ReplaceFile(figure, ChartFileSvg(chart));
}

}  // namespace
}  // namespace windhover

int main(int argc, char** argv) {
  std::string scenario, figure;
  CLI::App app("measures what a swarm costs by its pairs");
  app.add_option("scenario", scenario)->required()->check(CLI::ExistingFile);
  app.add_option("figure", figure, "chart to write (.svg)")->required();
  CLI11_PARSE(app, argc, argv);
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("cost_{}", getpid());
  std::filesystem::create_directories(folder);
  try {
    windhover::Run(scenario, figure, folder);
  } catch (const std::exception& e) {
    std::cerr << e.what() << "\n";
    return 1;
  }
  std::filesystem::remove_all(folder);
  return 0;
}
