#include "eval/swarm_ticks.h"

#include <algorithm>
#include <map>

#include <Eigen/Dense>

#include "eval/braking.h"
#include "eval/samples.h"

namespace windhover {
namespace {

constexpr double kMovingSpeed_mps = 0.1;

std::optional<double> LeastSeparation_m(const world_truth_t& tick) {
  std::optional<double> least_m;
  for (std::size_t i = 0; i < tick.uavs.size(); ++i) {
    for (std::size_t j = i + 1; j < tick.uavs.size(); ++j) {
      const double separation_m = Separation_m(tick.uavs[i], tick.uavs[j]);
      least_m = std::min(least_m.value_or(separation_m), separation_m);
    }
  }
  return least_m;
}

std::optional<double> Order(const world_truth_t& tick) {
  Eigen::Vector3d heading_sum = Eigen::Vector3d::Zero();
  int n_moving = 0;
  for (const uav_truth_t& uav : tick.uavs) {
    const Eigen::Vector3d v_mps(uav.v_WB_mps);
    if (v_mps.norm() < kMovingSpeed_mps) continue;
    heading_sum += v_mps.normalized();
    ++n_moving;
  }
  if (n_moving < 2) return std::nullopt;
  return heading_sum.norm() / n_moving;
}

/// Which aircraft are linked by sight.
class SightGraph {
 public:
  explicit SightGraph(const world_truth_t& tick) {
    for (const uav_truth_t& uav : tick.uavs) {
      index_.emplace(uav.id, static_cast<Eigen::Index>(index_.size()));
    }
    linked_ = Eigen::MatrixXd::Zero(size(), size());
  }

  Eigen::Index size() const { return static_cast<Eigen::Index>(index_.size()); }

  void LinkSeen(const ObserverFrame& frame) {
    for (const target_annotation_t& target : frame.truth.targets) {
      const auto from = index_.find(frame.observer_id), to = index_.find(target.target_id);
      if (from == index_.end() || to == index_.end() || !InViewOfBoth(target)) continue;
      linked_(from->second, to->second) = linked_(to->second, from->second) = 1;
    }
  }

  /// Share of all in the largest group that is linked, directly or over others.
  double LargestShare() const {
    return Reached().rowwise().sum().maxCoeff() / static_cast<double>(linked_.rows());
  }

  int Groups() const {
    const Eigen::MatrixXd reached = Reached();
    int groups = 0;
    for (Eigen::Index i = 0; i < reached.rows(); ++i) {
      groups += reached.row(i).head(i).sum() == 0 ? 1 : 0;  // The first of its group.
    }
    return groups;
  }

  double AlgebraicConnectivity() const {
    Eigen::MatrixXd laplacian = -linked_;
    laplacian.diagonal() += linked_.rowwise().sum();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(laplacian, Eigen::EigenvaluesOnly);
    // Ascending; what rounding leaves of a 0 is below 1e-12.
    const double second = solver.eigenvalues()[1];
    return second < 1e-12 ? 0 : second / static_cast<double>(linked_.rows());
  }

 private:
  /// 1 where a chain of links leads from one to the other, or to oneself.
  Eigen::MatrixXd Reached() const {
    const Eigen::Index n = linked_.rows();
    Eigen::MatrixXd reached = linked_ + Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index length = 1; length < n; length *= 2) {
      reached = (reached * reached).cwiseMin(1.0);
    }
    return reached;
  }

  std::map<int, Eigen::Index> index_;
  Eigen::MatrixXd linked_;
};

class TickReader {
 public:
  explicit TickReader(const RunRecord& run) : run_(run) {
    for (const ObserverFrame& frame : run.frames) frames_[frame.utime].push_back(&frame);
    for (const velocity_command_t& command : run.commands) {
      commands_[command.utime].push_back(&command);
    }
    for (const Aircraft& aircraft : run.scenario.aircraft) {
      by_swarm_[aircraft.self.id] = aircraft.self.controller == Controller::kSwarm;
    }
  }

  SwarmTick Read(const world_truth_t& world) const {
    SwarmTick tick{.utime = world.utime,
                   .separation_m = LeastSeparation_m(world),
                   .order = Order(world),
                   .connectivity = {},
                   .algebraic_connectivity = {},
                   .union_by_sight = {},
                   .braking = Braking(world)};
    const auto frames = frames_.find(world.utime);
    if (frames == frames_.end() || world.uavs.size() < 2) return tick;
    SightGraph graph(world);
    for (const ObserverFrame* frame : frames->second) graph.LinkSeen(*frame);
    const auto others = static_cast<double>(graph.size() - 1);
    tick.connectivity = graph.LargestShare();
    tick.algebraic_connectivity = graph.AlgebraicConnectivity();
    tick.union_by_sight = (others + 1 - graph.Groups()) / others;
    return tick;
  }

 private:
  BrakingCounts Braking(const world_truth_t& world) const {
    BrakingCounts counts;
    const auto commands = commands_.find(world.utime);
    if (commands == commands_.end() || !run_.scenario.swarm.guard.enabled) return counts;
    for (const velocity_command_t* command : commands->second) {
      const auto by_swarm = by_swarm_.find(command->id);
      const uav_truth_t* self = Find(world, command->id);
      if (by_swarm == by_swarm_.end() || !by_swarm->second || self == nullptr) continue;
      const bool must =
          MustBrake(run_.scenario.swarm, *self, world, Eigen::Vector3d(command->wish_WB_mps));
      const bool does = command->is_guarded != 0;
      ++counts.commands;
      counts.guarded += does ? 1 : 0;
      counts.false_brakes += does && !must ? 1 : 0;
      counts.missed_brakes += must && !does ? 1 : 0;
    }
    return counts;
  }

  const RunRecord& run_;
  std::map<Utime, std::vector<const ObserverFrame*>> frames_;
  std::map<Utime, std::vector<const velocity_command_t*>> commands_;
  std::map<int, bool> by_swarm_;
};

}  // namespace

std::vector<SwarmTick> SwarmTicks(const RunRecord& run) {
  const TickReader reader(run);
  std::vector<SwarmTick> ticks;
  ticks.reserve(run.world.size());
  for (const world_truth_t& world : run.world) ticks.push_back(reader.Read(world));
  return ticks;
}

}  // namespace windhover
