#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "common/cpu/instruction_set.h"
#include "rig/sinusoids.h"

namespace windhover {

/// Sums of sinusoids of any frequencies, by their Taylor series about anchors: moments evenly
/// spaced so closely that no line turns by more than 3.4 rad to either side. The first term left
/// out, 3.4^28 / 28!, is 3e-15 of the amplitudes, the largest kept 7 times them: 1e-14 by rounding.
/// Whoever asks for times about one anchor pays for the lines once; all times go through their
/// anchor, so that their values are functions of time alone.
class AnchoredSums {
 public:
  explicit AnchoredSums(const std::vector<Sinusoids>& sums);

  /// All sums about one anchor.
  struct Series {
    double anchor_s = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> coefficients;  ///< Of each power, those of all sums.
  };

  /// Writes the value of each sum at `t_s`. `series`, of any anchor, is made that of t_s.
  void At(double t_s, InstructionSet instructions, Series* series, double* values) const;

  /// The same, line by line: cheaper for a time without neighbours, by other roundings (1e-13 of
  /// the amplitudes).
  void AtAlone(double t_s, InstructionSet instructions, double* values) const;

  /// At most 512 lines that several sums share, filled up to a multiple of eight: frequencies, the
  /// angle by which each turns from an anchor to half way to the next, and of each sum first all
  /// cosine, then all sine amplitudes.
  struct Group {
    std::vector<std::size_t> sums;
    std::vector<double> frequencies_hz, angles_rad, squares_rad2, amplitudes;
  };

 private:
  void Expand(double anchor_s, InstructionSet instructions, Series* series) const;

  std::size_t n_sums_, n_padded_;  ///< n_padded_: a multiple of eight.
  double spacing_s_ = 1;
  std::vector<Group> groups_;
};

}  // namespace windhover
