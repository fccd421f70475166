#include "eval/swarm_metrics.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "eval/samples.h"

namespace windhover {
namespace {

constexpr double kMovingSpeed_mps = 0.1;

double Separation_m(const uav_truth_t& a, const uav_truth_t& b) {
  return (Eigen::Vector3d(a.p_WB_m) - Eigen::Vector3d(b.p_WB_m)).norm();
}

/// Counts how often each pair comes closer than a limit.
class CloseEncounters {
 public:
  explicit CloseEncounters(double limit_m) : limit_m_(limit_m) {}

  void See(std::pair<int, int> pair, double separation_m) {
    const bool is_close = separation_m < limit_m_;
    bool& was_close = was_close_[pair];
    if (is_close && !was_close) ++count_;
    was_close = is_close;
  }
  int count() const { return count_; }

 private:
  double limit_m_;
  int count_ = 0;
  std::map<std::pair<int, int>, bool> was_close_;
};

void MeasureSeparation(std::span<const world_truth_t> world, const ScoreConfig& score,
                       SwarmMetrics* metrics) {
  CloseEncounters collisions(score.collision_m), near_misses(score.near_miss_m);
  for (const world_truth_t& tick : world) {
    for (std::size_t i = 0; i < tick.uavs.size(); ++i) {
      for (std::size_t j = i + 1; j < tick.uavs.size(); ++j) {
        const double separation_m = Separation_m(tick.uavs[i], tick.uavs[j]);
        const std::pair<int, int> pair{tick.uavs[i].id, tick.uavs[j].id};
        collisions.See(pair, separation_m);
        near_misses.See(pair, separation_m);
        metrics->min_separation_m =
            std::min(metrics->min_separation_m.value_or(separation_m), separation_m);
      }
    }
  }
  if (!metrics->min_separation_m) return;
  metrics->collisions = collisions.count();
  metrics->near_misses = near_misses.count();
}

std::optional<double> Order(std::span<const world_truth_t> world) {
  double sum = 0;
  int n_ticks = 0;
  for (const world_truth_t& tick : world) {
    Eigen::Vector3d heading_sum = Eigen::Vector3d::Zero();
    int n_moving = 0;
    for (const uav_truth_t& uav : tick.uavs) {
      const Eigen::Vector3d v_mps(uav.v_WB_mps);
      if (v_mps.norm() < kMovingSpeed_mps) continue;
      heading_sum += v_mps.normalized();
      ++n_moving;
    }
    if (n_moving < 2) continue;
    sum += heading_sum.norm() / n_moving;
    ++n_ticks;
  }
  if (n_ticks == 0) return std::nullopt;
  return sum / n_ticks;
}

/// Which aircraft are linked by sight.
class SightGraph {
 public:
  explicit SightGraph(std::size_t n)
      : linked_(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n))) {
  }

  void Link(std::size_t i, std::size_t j) {
    const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(j);
    linked_(row, column) = linked_(column, row) = 1;
  }

  /// Share of all in the largest group that is linked, directly or over others.
  double LargestShare() const {
    const Eigen::Index n = linked_.rows();
    Eigen::MatrixXd reached = linked_ + Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index length = 1; length < n; length *= 2) {
      reached = (reached * reached).cwiseMin(1.0);
    }
    return reached.rowwise().sum().maxCoeff() / static_cast<double>(n);
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
  Eigen::MatrixXd linked_;
};

void MeasureSight(std::span<const world_truth_t> world, std::span<const ObserverFrame> frames,
                  SwarmMetrics* metrics) {
  if (world.empty() || world.front().uavs.size() < 2) return;
  std::map<int, std::size_t> index;
  for (const uav_truth_t& uav : world.front().uavs) index.emplace(uav.id, index.size());
  std::map<Utime, SightGraph> graphs;
  for (const ObserverFrame& frame : frames) {
    SightGraph& graph = graphs.try_emplace(frame.utime, index.size()).first->second;
    for (const target_annotation_t& target : frame.truth.targets) {
      const auto from = index.find(frame.observer_id), to = index.find(target.target_id);
      if (from == index.end() || to == index.end() || !InViewOfBoth(target)) continue;
      graph.Link(from->second, to->second);
    }
  }
  if (graphs.empty()) return;
  double share = 0, algebraic = 0;
  for (const auto& [utime, graph] : graphs) {
    share += graph.LargestShare();
    algebraic += graph.AlgebraicConnectivity();
  }
  const auto n = static_cast<double>(graphs.size());
  metrics->connectivity = share / n;
  metrics->algebraic_connectivity = algebraic / n;
}

}  // namespace

SwarmMetrics ComputeSwarmMetrics(std::span<const world_truth_t> world,
                                 std::span<const ObserverFrame> frames, const ScoreConfig& score) {
  SwarmMetrics metrics;
  MeasureSeparation(world, score, &metrics);
  metrics.order = Order(world);
  MeasureSight(world, frames, &metrics);
  return metrics;
}

}  // namespace windhover
