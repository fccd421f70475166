// Flies a scenario's swarm for many seeds without images or a bus: every aircraft in view of both
// cameras is triangulated from the pixels of its centre, if wanted with noise and with a disparity
// that is off. Says how near they came, how well they flew together, and what control costs.
//
//     swarm_bench scenarios/flock_6.yaml --seeds 200 [--set a.b=c] [--noise 1] [--offset -5]

#include <algorithm>
#include <ctime>
#include <iostream>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/random/random_stream.h"
#include "scenarios/scenario.h"
#include "sim/onboard_sensors.h"
#include "sim/world.h"
#include "swarm/flight_controller.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

struct Options {
  std::string file;
  int seeds = 200;
  double noise_px = 0, offset_px = 0;
  std::vector<std::string> overrides;
};

/// What one flight came to.
struct Flight {
  double least_m = 1e9;
  int collisions = 0, near_misses = 0;
  double order = 0, seen = 0, guarded = 0, end_spread_m = 0;  // Means over ticks; at the end.
  double control_us = 0;                                      // CPU time per aircraft and tick.
};

double CpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

class Flyer {
 public:
  Flyer(const Scenario& scenario, const Options& options)
      : scenario_(scenario),
        options_(options),
        config_(scenario.ForAircraft()),
        rig_(config_.rig.ToStereoRig()),
        world_(scenario),
        sensors_(scenario),
        noise_(scenario.random_seed, "bench/disparity") {
    for (const AircraftSelf& self : config_.aircraft) {
      controllers_.push_back(MakeFlightController(config_, self));
    }
  }

  Flight Fly() {
    const int n_ticks = NumberOfTicks(scenario_);
    for (int tick = 0; tick < n_ticks; ++tick) {
      world_.AdvanceTo(UtimeOfTick(tick, scenario_.frame_rate_hz));
      Judge();
      for (int i = 0; i < world_.size(); ++i) Command(i, tick);
    }
    const double n = n_ticks;
    flight_.order /= n;
    flight_.seen /= n * world_.size();
    flight_.guarded /= n * world_.size();
    flight_.control_us /= n * world_.size();
    for (int i = 0; i < world_.size(); ++i) {
      for (int j = 0; j < i; ++j) {
        flight_.end_spread_m = std::max(flight_.end_spread_m,
                                        (world_.State(i).p_WB_m - world_.State(j).p_WB_m).norm());
      }
    }
    return flight_;
  }

 private:
  void Judge() {
    Vector3d sum = Vector3d::Zero();
    for (int i = 0; i < world_.size(); ++i) {
      const Vector3d v = world_.State(i).v_WB_mps;
      if (v.norm() > 0.1) sum += v.normalized() / world_.size();
      for (int j = 0; j < i; ++j) {
        const double apart_m = (world_.State(i).p_WB_m - world_.State(j).p_WB_m).norm();
        flight_.least_m = std::min(flight_.least_m, apart_m);
        Count(apart_m < scenario_.score.collision_m, {i, j}, &colliding_, &flight_.collisions);
        Count(apart_m < scenario_.score.near_miss_m, {i, j}, &near_, &flight_.near_misses);
      }
    }
    flight_.order += sum.norm();
  }

  static void Count(bool is_close, std::pair<int, int> pair, std::set<std::pair<int, int>>* close,
                    int* count) {
    if (!is_close) {
      close->erase(pair);
    } else if (close->insert(pair).second) {
      ++*count;
    }
  }

  void Command(int i, int tick) {
    if (!controllers_[static_cast<std::size_t>(i)]) return;
    nav_state_t nav = sensors_.Nav(world_, i, tick);
    nav.utime = UtimeOfTick(tick, scenario_.frame_rate_hz);
    const range_t ranges = Sight(i);
    const double start_s = CpuSeconds();
    const velocity_command_t command =
        controllers_[static_cast<std::size_t>(i)]->Control(nav, ranges);
    flight_.control_us += 1e6 * (CpuSeconds() - start_s);
    flight_.guarded += command.is_guarded;
    world_.Command(i, {Vector3d(command.v_WB_mps), command.yaw_rate_radps});
  }

  range_t Sight(int i) {
    Eigen::Isometry3d X_WR = Eigen::Isometry3d::Identity();
    X_WR.translation() = world_.State(i).p_WB_m;
    X_WR.linear() = world_.State(i).q_WB.toRotationMatrix();
    X_WR = X_WR * config_.rig.X_BR();
    range_t ranges{};
    for (int j = 0; j < world_.size(); ++j) {
      if (j == i) continue;
      const auto seen = Project(Posed(rig_), X_WR.inverse() * world_.State(j).p_WB_m);
      if (!seen || !InImage(seen->left_px) || !InImage(seen->right_px)) continue;
      const double error_px = options_.offset_px + options_.noise_px * noise_.Normal();
      const auto point = Triangulate(rig_, seen->left_px + Eigen::Vector2d(error_px / 2, 0),
                                     seen->right_px - Eigen::Vector2d(error_px / 2, 0),
                                     config_.estimator.disparity_sigma_px);
      if (!point) continue;
      range_estimate_t estimate{};
      estimate.method = config_.estimator.in_loop;
      estimate.track_id = j;
      estimate.range_m = point->range_m;
      estimate.range_sigma_m = point->range_sigma_m;
      std::copy_n(point->p_RT_m.data(), 3, estimate.p_RT_m);
      ranges.estimates.push_back(estimate);
    }
    ranges.n_estimates = static_cast<int>(ranges.estimates.size());
    flight_.seen += ranges.n_estimates;
    return ranges;
  }

  bool InImage(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < rig_.width_px &&
           pixel.y() < rig_.height_px;
  }

  const Scenario& scenario_;
  const Options& options_;
  AircraftConfig config_;
  StereoRig rig_;
  World world_;
  OnboardSensors sensors_;
  RandomStream noise_;
  std::vector<std::unique_ptr<FlightController>> controllers_;
  Flight flight_;
  std::set<std::pair<int, int>> colliding_, near_;
};

void Print(const std::vector<Flight>& flights, double cpu_s) {
  const auto mean = [&](auto member) {
    double sum = 0;
    for (const Flight& flight : flights) sum += flight.*member;
    return sum / static_cast<double>(flights.size());
  };
  std::vector<double> least_m;
  int hit = 0, near = 0;
  for (const Flight& flight : flights) {
    least_m.push_back(flight.least_m);
    hit += flight.collisions > 0;
    near += flight.near_misses > 0;
  }
  std::sort(least_m.begin(), least_m.end());
  fmt::print(
      "flights {}; with collisions {}, near misses {}; least separation {:.2f} m, median "
      "{:.2f} m\n",
      flights.size(), hit, near, least_m.front(), least_m[least_m.size() / 2]);
  fmt::print(
      "order {:.3f}; in view {:.2f}; guarded {:.3f}; widest at the end {:.1f} m; control "
      "{:.1f} us per aircraft and tick; {:.2f} s of CPU per flight\n",
      mean(&Flight::order), mean(&Flight::seen), mean(&Flight::guarded),
      mean(&Flight::end_spread_m), mean(&Flight::control_us),
      cpu_s / static_cast<double>(flights.size()));
}

void Run(const Options& options) {
  std::vector<Flight> flights;
  const double start_s = CpuSeconds();
  for (int seed = 1; seed <= options.seeds; ++seed) {
    std::vector<std::string> overrides = options.overrides;
    overrides.push_back(fmt::format("random_seed={}", seed));
    flights.push_back(Flyer(LoadScenario(options.file, overrides), options).Fly());
  }
  Print(flights, CpuSeconds() - start_s);
}

}  // namespace
}  // namespace windhover

int main(int argc, char** argv) {
  windhover::Options options;
  CLI::App app("flies a swarm for many seeds, by sight without images");
  app.add_option("scenario", options.file)->required();
  app.add_option("--seeds", options.seeds)->check(CLI::PositiveNumber);
  app.add_option("--noise", options.noise_px, "sigma of a disparity, px");
  app.add_option("--offset", options.offset_px, "measured minus true disparity, px");
  app.add_option("--set", options.overrides);
  CLI11_PARSE(app, argc, argv);
  try {
    windhover::Run(options);
  } catch (const std::exception& e) {
    std::cerr << e.what() << "\n";
    return 2;
  }
  return 0;
}
