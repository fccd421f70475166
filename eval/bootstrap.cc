#include "eval/bootstrap.h"

#include <algorithm>
#include <cmath>

#include "common/random/random_stream.h"

namespace windhover {
namespace {

/// Value below which the share `p` of the sorted values lies; linear in between.
double Quantile(const std::vector<double>& sorted, double p) {
  const double at = p * static_cast<double>(sorted.size() - 1);
  const std::size_t below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double t = at - static_cast<double>(below);
  return (1 - t) * sorted[below] + t * sorted[above];
}

double NormalCdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

}  // namespace

TimeBlocks::TimeBlocks(Utime first, Utime last, double period_s, double min_block_s)
    : first_(first), span_(last - first + std::max<Utime>(1, UtimeFromSeconds(period_s))) {
  // A microsecond of slack: ten frames of 0.1 s that were rounded are still one second.
  const double n_blocks = (SecondsFromUtime(span_) + 1e-6) / min_block_s;
  count_ = std::max(1, static_cast<int>(n_blocks));
}

int TimeBlocks::BlockOf(Utime utime) const {
  const double share = static_cast<double>(utime - first_) / static_cast<double>(span_);
  return std::clamp(static_cast<int>(share * count_), 0, count_ - 1);
}

double StudentT975(int degrees_of_freedom) {
  const double z = 1.959963984540054;
  const double n = degrees_of_freedom;
  const double z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z, z9 = z7 * z * z;
  return z + (z3 + z) / (4 * n) + (5 * z5 + 16 * z3 + 3 * z) / (96 * n * n) +
         (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * n * n * n) +
         (79 * z9 + 776 * z7 + 1482 * z5 - 1920 * z3 - 945 * z) / (92160 * n * n * n * n);
}

std::optional<std::array<double, 2>> BootstrapInterval95(std::span<const BlockSum> blocks,
                                                         std::uint64_t seed, int n_resamples) {
  std::vector<BlockSum> filled;
  for (const BlockSum& block : blocks) {
    if (block.count > 0) filled.push_back(block);
  }
  const int n = static_cast<int>(filled.size());
  if (n < 2) return std::nullopt;
  RandomStream random(seed, "eval/bootstrap");
  std::vector<double> means(static_cast<std::size_t>(n_resamples));
  for (double& mean : means) {
    BlockSum total;
    for (int i = 0; i < n; ++i) {
      const BlockSum& drawn = filled[static_cast<std::size_t>(random.Uniform() * n)];
      total.sum += drawn.sum;
      total.count += drawn.count;
    }
    mean = total.sum / total.count;
  }
  std::sort(means.begin(), means.end());
  const double expanded_z = std::sqrt(n / (n - 1.0)) * StudentT975(n - 1);
  const double tail = NormalCdf(-expanded_z);
  return std::array<double, 2>{Quantile(means, tail), Quantile(means, 1 - tail)};
}

}  // namespace windhover
