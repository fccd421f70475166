#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/time/sim_time.h"

namespace windhover {

/// A mean of time-stamped terms, as a bootstrap sees it: one sum and one count a block.
struct BlockSum {
  double sum = 0;
  int count = 0;
};

/// Neighbouring blocks of at least `min_block_s` each that cover [first, last]; errors closer
/// than a block are taken as dependent (the rig drifts slowly), errors of different blocks are
/// not.
class TimeBlocks {
 public:
  /// `period_s`: between frames, so that the last frame counts as long as the others.
  TimeBlocks(Utime first, Utime last, double period_s, double min_block_s);

  int count() const { return count_; }
  int BlockOf(Utime utime) const;

 private:
  Utime first_;
  Utime span_;
  int count_;
};

/// 95 % confidence interval of sum/count over all blocks, by resampling blocks `n_resamples`
/// times with replacement; the same `seed` draws the same blocks, so intervals of two methods
/// are paired.
///
/// Percentile intervals of few blocks are too narrow: the percentiles are moved outwards as
/// Student's t demands ("expanded percentile", T. C. Hesterberg, "What Teachers Should Know
/// about the Bootstrap", The American Statistician 69(4), 2015).
/// @return nothing for fewer than two blocks with terms in them.
std::optional<std::array<double, 2>> BootstrapInterval95(std::span<const BlockSum> blocks,
                                                         std::uint64_t seed,
                                                         int n_resamples = 1000);

/// Half-width of a two-sided 95 % interval of Student's t in standard errors; Cornish-Fisher
/// expansion (Abramowitz & Stegun 26.7.5), within 1 % from 4 degrees of freedom on.
double StudentT975(int degrees_of_freedom);

}  // namespace windhover
