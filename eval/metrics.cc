#include "eval/metrics.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace windhover {
namespace {

using Predicate = std::function<bool(const ScoredFrame&)>;

/// Sums of one term over all frames and over each block.
class BlockedMean {
 public:
  explicit BlockedMean(int n_blocks) : blocks_(static_cast<std::size_t>(n_blocks)) {}

  void Add(int block, double term) {
    BlockSum& in = blocks_[static_cast<std::size_t>(block)];
    in.sum += term;
    ++in.count;
    total_.sum += term;
    ++total_.count;
  }

  std::optional<double> Mean() const {
    if (total_.count == 0) return std::nullopt;
    return total_.sum / total_.count;
  }

  void WriteInterval(const std::string& name, std::uint64_t seed, ErrorMetrics* metrics) const {
    const auto interval = BootstrapInterval95(blocks_, seed);
    if (interval) metrics->ci95[name] = *interval;
  }

 private:
  std::vector<BlockSum> blocks_;
  BlockSum total_;
};

std::vector<ScoredFrame> Select(std::span<const ScoredFrame> frames, const Predicate& keep) {
  std::vector<ScoredFrame> kept;
  std::copy_if(frames.begin(), frames.end(), std::back_inserter(kept), keep);
  return kept;
}

TimeBlocks BlocksOf(const std::vector<ScoredFrame>& frames, double frame_period_s) {
  if (frames.empty()) return TimeBlocks(0, 0, frame_period_s, kMinBlock_s);
  const auto [first, last] = std::minmax_element(
      frames.begin(), frames.end(), [](auto& a, auto& b) { return a.utime < b.utime; });
  return TimeBlocks(first->utime, last->utime, frame_period_s, kMinBlock_s);
}

std::vector<DistanceBin> ScoreByDistance(const std::vector<ScoredFrame>& frames,
                                         const TimeBlocks& blocks, std::uint64_t seed) {
  std::map<int, std::vector<ScoredFrame>> bins;
  for (const ScoredFrame& frame : frames) {
    bins[static_cast<int>(frame.reference_m / kDistanceBin_m)].push_back(frame);
  }
  std::vector<DistanceBin> scored;
  for (const auto& [bin, in_bin] : bins) {
    scored.push_back({bin * kDistanceBin_m, (bin + 1) * kDistanceBin_m,
                      ComputeErrorMetrics(in_bin, blocks, seed)});
  }
  return scored;
}

/// Frames of method `m` for which all methods have an estimate.
std::vector<ScoredFrame> SharedFrames(const std::vector<std::vector<ScoredFrame>>& frames,
                                      std::size_t m) {
  std::vector<ScoredFrame> shared;
  for (std::size_t i = 0; i < frames[m].size(); ++i) {
    const bool in_all = std::all_of(frames.begin(), frames.end(),
                                    [i](auto& of_one) { return of_one[i].estimate_m.has_value(); });
    if (in_all) shared.push_back(frames[m][i]);
  }
  return shared;
}

}  // namespace

ErrorMetrics ComputeErrorMetrics(std::span<const ScoredFrame> frames, const TimeBlocks& blocks,
                                 std::uint64_t seed) {
  BlockedMean abs_rel_all(blocks.count()), abs_rel(blocks.count()), sq_rel(blocks.count()),
      bias(blocks.count()), square(1), delta(1), nees(1), coverage(1);
  for (const ScoredFrame& frame : frames) {
    const int block = blocks.BlockOf(frame.utime);
    if (!frame.estimate_m) {
      abs_rel_all.Add(block, 1);
      continue;
    }
    const double error_m = *frame.estimate_m - frame.reference_m;
    abs_rel_all.Add(block, std::abs(error_m) / frame.reference_m);
    abs_rel.Add(block, std::abs(error_m) / frame.reference_m);
    sq_rel.Add(block, error_m * error_m / frame.reference_m);
    bias.Add(block, error_m);
    square.Add(0, error_m * error_m);
    const double ratio = *frame.estimate_m / frame.reference_m;
    delta.Add(0, std::max(ratio, 1 / ratio) < 1.25 ? 1 : 0);
    if (!(frame.sigma_m > 0)) continue;
    nees.Add(0, error_m * error_m / (frame.sigma_m * frame.sigma_m));
    coverage.Add(0, std::abs(error_m) <= 1.96 * frame.sigma_m ? 1 : 0);
  }
  ErrorMetrics metrics;
  metrics.n = static_cast<int>(frames.size());
  for (const ScoredFrame& frame : frames) metrics.detected += frame.estimate_m.has_value();
  metrics.abs_rel_all = abs_rel_all.Mean();
  metrics.abs_rel = abs_rel.Mean();
  metrics.sq_rel = sq_rel.Mean();
  metrics.bias_m = bias.Mean();
  if (square.Mean()) metrics.rmse_m = std::sqrt(*square.Mean());
  metrics.delta_1_25 = delta.Mean();
  metrics.nees = nees.Mean();
  metrics.coverage_95 = coverage.Mean();
  abs_rel_all.WriteInterval("abs_rel_all", seed, &metrics);
  abs_rel.WriteInterval("abs_rel", seed, &metrics);
  sq_rel.WriteInterval("sq_rel", seed, &metrics);
  bias.WriteInterval("bias_m", seed, &metrics);
  return metrics;
}

std::vector<MethodScore> ScoreMethods(const std::vector<std::string>& methods,
                                      const std::vector<std::vector<ScoredFrame>>& frames,
                                      double frame_period_s, std::uint64_t seed) {
  std::vector<MethodScore> scores;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const TimeBlocks blocks = BlocksOf(frames[m], frame_period_s);
    const auto near = [](const ScoredFrame& f) { return f.reference_m < kNearFar_m; };
    MethodScore score;
    score.method = methods[m];
    score.all = ComputeErrorMetrics(frames[m], blocks, seed);
    score.by_distance = ScoreByDistance(frames[m], blocks, seed);
    score.lt20 = ComputeErrorMetrics(Select(frames[m], near), blocks, seed);
    score.gt20 = ComputeErrorMetrics(Select(frames[m], std::not_fn(near)), blocks, seed);
    score.shared = ComputeErrorMetrics(SharedFrames(frames, m), blocks, seed);
    scores.push_back(std::move(score));
  }
  return scores;
}

std::optional<double> Median(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  if (values.size() % 2 == 1) return values[middle];
  return (values[middle - 1] + values[middle]) / 2;
}

}  // namespace windhover
