#include "eval/swarm_metrics.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "eval/bootstrap.h"
#include "eval/metrics.h"
#include "eval/samples.h"

namespace windhover {
namespace {

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

void CountEncounters(const RunRecord& run, SwarmMetrics* metrics) {
  const ScoreConfig& score = run.scenario.score;
  CloseEncounters collisions(score.collision_m), near_misses(score.near_miss_m);
  for (const world_truth_t& tick : run.world) {
    for (std::size_t i = 0; i < tick.uavs.size(); ++i) {
      for (std::size_t j = i + 1; j < tick.uavs.size(); ++j) {
        const double separation_m = Separation_m(tick.uavs[i], tick.uavs[j]);
        const std::pair<int, int> pair{tick.uavs[i].id, tick.uavs[j].id};
        collisions.See(pair, separation_m);
        near_misses.See(pair, separation_m);
      }
    }
  }
  metrics->collisions = collisions.count();
  metrics->near_misses = near_misses.count();
}

/// Means over the ticks of a run, with intervals.
class TickMeans {
 public:
  TickMeans(const RunRecord& run, std::span<const SwarmTick> ticks, SwarmMetrics* metrics)
      : ticks_(ticks),
        seed_(run.scenario.random_seed),
        blocks_(ticks.front().utime, ticks.back().utime, 1 / run.scenario.frame_rate_hz,
                kMinBlock_s),
        metrics_(metrics) {}

  /// `term(tick)`: sum and count of what the tick adds.
  template <typename Term>
  std::optional<double> Mean(const char* name, Term term) {
    std::vector<BlockSum> sums(static_cast<std::size_t>(blocks_.count()));
    BlockSum total;
    for (const SwarmTick& tick : ticks_) {
      const BlockSum more = term(tick);
      for (BlockSum* sum : {&total, &sums[static_cast<std::size_t>(blocks_.BlockOf(tick.utime))]}) {
        sum->sum += more.sum;
        sum->count += more.count;
      }
    }
    if (total.count == 0) return std::nullopt;
    if (const auto ci95 = BootstrapInterval95(sums, seed_)) metrics_->ci95[name] = *ci95;
    return total.sum / total.count;
  }

  std::optional<double> Mean(const char* name, std::optional<double> SwarmTick::*member) {
    return Mean(name, [&](const SwarmTick& tick) {
      return BlockSum{(tick.*member).value_or(0), tick.*member ? 1 : 0};
    });
  }

  std::optional<double> Share(const char* name, int BrakingCounts::*member) {
    return Mean(name, [&](const SwarmTick& tick) {
      return BlockSum{static_cast<double>(tick.braking.*member), tick.braking.commands};
    });
  }

 private:
  std::span<const SwarmTick> ticks_;
  std::uint64_t seed_;
  TimeBlocks blocks_;
  SwarmMetrics* metrics_;
};

void SummariseTicks(const RunRecord& run, std::span<const SwarmTick> ticks, SwarmMetrics* metrics) {
  if (ticks.empty()) return;
  for (const SwarmTick& tick : ticks) {
    if (!tick.separation_m) continue;
    metrics->min_separation_m =
        std::min(metrics->min_separation_m.value_or(*tick.separation_m), *tick.separation_m);
  }
  if (metrics->min_separation_m) CountEncounters(run, metrics);
  TickMeans means(run, ticks, metrics);
  metrics->order = means.Mean("order", &SwarmTick::order);
  metrics->connectivity = means.Mean("connectivity", &SwarmTick::connectivity);
  metrics->algebraic_connectivity =
      means.Mean("algebraic_connectivity", &SwarmTick::algebraic_connectivity);
  metrics->union_by_sight = means.Mean("union_by_sight", &SwarmTick::union_by_sight);
  metrics->guarded = means.Share("guarded", &BrakingCounts::guarded);
  metrics->false_brakes = means.Share("false_brakes", &BrakingCounts::false_brakes);
  metrics->missed_brakes = means.Share("missed_brakes", &BrakingCounts::missed_brakes);
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

/// Looks at detections with the truth beside them.
class Sightings {
 public:
  explicit Sightings(const RunRecord& run) : near_miss_m_(run.scenario.score.near_miss_m) {
    for (const world_truth_t& tick : run.world) ticks_[tick.utime] = &tick;
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

SwarmMetrics ComputeSwarmMetrics(const RunRecord& run, std::span<const SwarmTick> ticks) {
  SwarmMetrics metrics;
  SummariseTicks(run, ticks, &metrics);
  Sightings sightings(run);
  for (const ObserverFrame& frame : run.frames) sightings.See(frame);
  metrics.first_sight_to_near_miss_s = sightings.least_s();
  metrics.track_purity = sightings.Purity();
  return metrics;
}

}  // namespace windhover
