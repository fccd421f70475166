#include "eval/swarm_metrics.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Core>

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

/// Groups of aircraft that are linked, directly or over others (union-find).
class LinkedGroups {
 public:
  explicit LinkedGroups(std::size_t n) : parent_(n) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t GroupOf(std::size_t i) const {
    while (parent_[i] != i) i = parent_[i];
    return i;
  }
  void Link(std::size_t i, std::size_t j) { parent_[GroupOf(i)] = GroupOf(j); }

  double LargestShare() const {
    std::vector<int> size(parent_.size());
    for (std::size_t i = 0; i < parent_.size(); ++i) ++size[GroupOf(i)];
    return *std::max_element(size.begin(), size.end()) / static_cast<double>(parent_.size());
  }

 private:
  std::vector<std::size_t> parent_;
};

std::optional<double> Connectivity(std::span<const world_truth_t> world,
                                   std::span<const ObserverFrame> frames) {
  if (world.empty() || world.front().uavs.size() < 2) return std::nullopt;
  std::map<int, std::size_t> index;
  for (const uav_truth_t& uav : world.front().uavs) index.emplace(uav.id, index.size());
  std::map<Utime, LinkedGroups> groups;
  for (const ObserverFrame& frame : frames) {
    LinkedGroups& group = groups.try_emplace(frame.utime, index.size()).first->second;
    for (const target_annotation_t& target : frame.truth.targets) {
      const auto from = index.find(frame.observer_id), to = index.find(target.target_id);
      if (from == index.end() || to == index.end() || !InViewOfBoth(target)) continue;
      group.Link(from->second, to->second);
    }
  }
  if (groups.empty()) return std::nullopt;
  double sum = 0;
  for (const auto& [utime, group] : groups) sum += group.LargestShare();
  return sum / static_cast<double>(groups.size());
}

}  // namespace

SwarmMetrics ComputeSwarmMetrics(std::span<const world_truth_t> world,
                                 std::span<const ObserverFrame> frames, const ScoreConfig& score) {
  SwarmMetrics metrics;
  MeasureSeparation(world, score, &metrics);
  metrics.order = Order(world);
  metrics.connectivity = Connectivity(world, frames);
  return metrics;
}

}  // namespace windhover
