#pragma once

#include <span>
#include <vector>

#include "rig/anchored_sums.h"
#include "rig/periodic_sums.h"

namespace windhover {

/// Several sums of sinusoids, evaluated together: Value() of each to 1e-13 of its amplitudes (and
/// to 2π f t as a double holds it), far faster. Harmonics of one fundamental come from a table of
/// their period (PeriodicSums); other lines from series about anchors (AnchoredSums), where sums
/// with the same frequencies share sines and cosines.
class SinusoidSums {
 public:
  explicit SinusoidSums(const std::vector<Sinusoids>& sums);

  /// Writes the value of each sum at `t_s`. The same bits on every processor: all add in the same
  /// order, without fused operations.
  void At(double t_s, double* values, InstructionSet instructions = WidestInstructionSet()) const;

  /// The same for a time without neighbours, at a fifth of the cost and by other roundings.
  void AtAlone(double t_s, double* values,
               InstructionSet instructions = WidestInstructionSet()) const;

  /// The values at each of `times_s`, one time after the other: the bits of each alone. Cheapest
  /// where neighbours are close.
  std::vector<double> AtMany(std::span<const double> times_s,
                             InstructionSet instructions = WidestInstructionSet()) const;

 private:
  // A table and the sums that it is of.
  struct Table {
    std::vector<std::size_t> sums;
    PeriodicSums values;
  };

  void At(double t_s, InstructionSet instructions, AnchoredSums::Series* series,
          double* values) const;
  void AtOfTables(double t_s, double* values) const;

  std::size_t n_sums_;
  AnchoredSums anchored_;
  std::vector<Table> tables_;
};

}  // namespace windhover
