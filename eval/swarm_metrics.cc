#include "eval/swarm_metrics.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
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
  double share = 0, algebraic = 0, united = 0;
  const auto others = static_cast<double>(index.size() - 1);
  for (const auto& [utime, graph] : graphs) {
    share += graph.LargestShare();
    algebraic += graph.AlgebraicConnectivity();
    united += (others + 1 - graph.Groups()) / others;
  }
  const auto n = static_cast<double>(graphs.size());
  metrics->connectivity = share / n;
  metrics->union_by_sight = united / n;
  metrics->algebraic_connectivity = algebraic / n;
}

/// When two that keep their velocities are `limit_m` apart; nothing: never.
std::optional<double> TimeToNear_s(const uav_truth_t& a, const uav_truth_t& b, double limit_m) {
  const Eigen::Vector3d p_m = Eigen::Vector3d(b.p_WB_m) - Eigen::Vector3d(a.p_WB_m);
  const Eigen::Vector3d v_mps = Eigen::Vector3d(b.v_WB_mps) - Eigen::Vector3d(a.v_WB_mps);
  // |p + v t|² = limit²: the smaller root.
  const double beyond = p_m.squaredNorm() - limit_m * limit_m, closing = -p_m.dot(v_mps);
  if (beyond <= 0) return 0;
  const double root = closing * closing - v_mps.squaredNorm() * beyond;
  if (closing <= 0 || root < 0) return std::nullopt;
  return beyond / (closing + std::sqrt(root));
}

const uav_truth_t* Find(const world_truth_t& tick, int id) {
  for (const uav_truth_t& uav : tick.uavs) {
    if (uav.id == id) return &uav;
  }
  return nullptr;
}

/// Looks at detections with the truth beside them.
class Sightings {
 public:
  Sightings(std::span<const world_truth_t> world, double near_miss_m) : near_miss_m_(near_miss_m) {
    for (const world_truth_t& tick : world) ticks_[tick.utime] = &tick;
  }

  void See(const ObserverFrame& frame) {
    if (!frame.detections) return;
    const auto targets = Associate(*frame.detections, frame.truth);
    for (const auto& target : targets) {
      if (target) SeeTarget(frame, frame.truth.targets[*target].target_id);
    }
    if (!frame.ranges) return;
    std::set<int> counted;  // A detection has an estimate of each method, of one track.
    for (const range_estimate_t& estimate : frame.ranges->estimates) {
      const auto index = static_cast<std::size_t>(estimate.detection_index);
      if (index >= targets.size() || !counted.insert(estimate.detection_index).second) continue;
      const int id = targets[index] ? frame.truth.targets[*targets[index]].target_id : kNothing;
      ++tracks_[{frame.observer_id, estimate.track_id}][id];
    }
  }

  std::optional<double> Purity() const {
    int n = 0, n_of_most = 0;
    for (const auto& [track, counts] : tracks_) {
      int most = 0;
      for (const auto& [target, count] : counts) {
        n += count;
        most = std::max(most, count);
      }
      n_of_most += most;
    }
    if (n == 0) return std::nullopt;
    return static_cast<double>(n_of_most) / n;
  }

  std::optional<double> least_s() const { return least_s_; }

 private:
  static constexpr int kNothing = -1;

  void SeeTarget(const ObserverFrame& frame, int target_id) {
    const auto tick = ticks_.find(frame.utime);
    if (tick == ticks_.end() || !seen_.insert({frame.observer_id, target_id}).second) return;
    const uav_truth_t* observer = Find(*tick->second, frame.observer_id);
    const uav_truth_t* target = Find(*tick->second, target_id);
    if (observer == nullptr || target == nullptr) return;
    const auto time_s = TimeToNear_s(*observer, *target, near_miss_m_);
    if (time_s) least_s_ = std::min(least_s_.value_or(*time_s), *time_s);
  }

  double near_miss_m_;
  std::map<Utime, const world_truth_t*> ticks_;
  std::set<std::pair<int, int>> seen_;
  std::map<std::pair<int, int>, std::map<int, int>> tracks_;  ///< Detections by target.
  std::optional<double> least_s_;
};

}  // namespace

SwarmMetrics ComputeSwarmMetrics(std::span<const world_truth_t> world,
                                 std::span<const ObserverFrame> frames, const ScoreConfig& score) {
  SwarmMetrics metrics;
  MeasureSeparation(world, score, &metrics);
  metrics.order = Order(world);
  MeasureSight(world, frames, &metrics);
  Sightings sightings(world, score.near_miss_m);
  for (const ObserverFrame& frame : frames) sightings.See(frame);
  metrics.first_sight_to_near_miss_s = sightings.least_s();
  metrics.track_purity = sightings.Purity();
  return metrics;
}

}  // namespace windhover
