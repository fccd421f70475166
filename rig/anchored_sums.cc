#include "rig/anchored_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include "rig/lanes.h"

namespace windhover {
namespace {

using Group = AnchoredSums::Group;

constexpr std::size_t kTerms = 28, kMaxLines = 512;
constexpr double kMaxAngle_rad = 3.4;

// ±1 / n!, as in the series of cosine and sine.
constexpr std::array<double, kTerms> kFactors = [] {
  std::array<double, kTerms> factors{};
  double factorial = 1;
  for (std::size_t n = 0; n < kTerms; ++n) {
    if (n > 0) factorial *= static_cast<double>(n);
    factors[n] = (n % 4 < 2 ? 1 : -1) / factorial;
  }
  return factors;
}();

// Σ C x^2n over all lines, for n from 0 on: fourteen sums of eight lanes that do not meet before
// the end, so that they can be had a few at a time, all in registers.
template <std::size_t kWidth>
inline __attribute__((always_inline)) void SumPowers(const double* starts, const double* squares,
                                                     std::size_t n_lines, double* sums,
                                                     std::size_t stride) {
  using Vector = typename VectorOf<kWidth>::Type;
  std::array<std::array<double, kLanes>, kTerms / 2> lanes;
  for (std::size_t offset = 0; offset < kLanes; offset += kWidth) {
    std::array<Vector, kTerms / 2> terms{};
    for (std::size_t i = offset; i < n_lines; i += kLanes) {
      Vector term, square;
      Load(&starts[i], &term);
      Load(&squares[i], &square);
#pragma GCC unroll 14
      for (std::size_t n = 0; n < kTerms / 2; ++n) {
        terms[n] += term;
        term *= square;
      }
    }
#pragma GCC unroll 14  // All indices of `terms` are known, so that it is registers.
    for (std::size_t n = 0; n < kTerms / 2; ++n) Store(terms[n], &lanes[n][offset]);
  }
  for (std::size_t n = 0; n < kTerms / 2; ++n) {
    Lanes all;
    Load(lanes[n].data(), &all);
    sums[n * stride] += Sum(all);
  }
}

// cos and sin of 2π f t of all lines, whole blocks of them, two vectors at once.
template <std::size_t kWidth>
inline __attribute__((always_inline)) void CosSinAt(double t_s, const std::vector<double>& hz,
                                                    double* cosines, double* sines) {
  using Vector = typename VectorOf<kWidth>::Type;
  std::size_t i = 0;
  for (; i + 2 * kWidth <= hz.size(); i += 2 * kWidth) {
    TwoOf<Vector> frequency_hz, cos, sin;
    Load(&hz[i], &frequency_hz.first);
    Load(&hz[i + kWidth], &frequency_hz.second);
    CosSin(frequency_hz * t_s, &cos, &sin);
    Store(cos.first, &cosines[i]);
    Store(cos.second, &cosines[i + kWidth]);
    Store(sin.first, &sines[i]);
    Store(sin.second, &sines[i + kWidth]);
  }
  for (; i < hz.size(); i += kWidth) {
    Vector turns, cos, sin;
    Load(&hz[i], &turns);
    CosSin<Vector>(turns * t_s, &cos, &sin);
    Store(cos, &cosines[i]);
    Store(sin, &sines[i]);
  }
}

// A line a cos(2π f t) + b sin(2π f t) about an anchor is C cos(x τ) + S sin(x τ), where C and S
// are the line and its quadrature at the anchor, x is the line's angle and τ runs from -1 to 1.
// Adds C x^n of even and S x^n of odd n over all lines.
template <std::size_t kWidth>
inline __attribute__((always_inline)) void Expand(const Group& group, double anchor_s,
                                                  std::size_t n_sums, double* coefficients) {
  using Vector = typename VectorOf<kWidth>::Type;
  std::array<double, kMaxLines> cosines, sines, even, odd;
  const std::size_t n_lines = group.frequencies_hz.size();
  CosSinAt<kWidth>(anchor_s, group.frequencies_hz, cosines.data(), sines.data());
  const double *a_of = group.amplitudes.data(), *b_of = a_of + n_lines;
  for (const std::size_t sum : group.sums) {
    for (std::size_t i = 0; i < n_lines; i += kWidth) {
      Vector a, b, cos, sin, x;
      Load(a_of + i, &a);
      Load(b_of + i, &b);
      Load(&cosines[i], &cos);
      Load(&sines[i], &sin);
      Load(&group.angles_rad[i], &x);
      Store<Vector>(a * cos + b * sin, &even[i]);
      Store<Vector>((b * cos - a * sin) * x, &odd[i]);
    }
    a_of += 2 * n_lines;
    b_of += 2 * n_lines;
    double* const sums = coefficients + sum;
    SumPowers<kWidth>(even.data(), group.squares_rad2.data(), n_lines, sums, 2 * n_sums);
    SumPowers<kWidth>(odd.data(), group.squares_rad2.data(), n_lines, sums + n_sums, 2 * n_sums);
  }
}

template <std::size_t kWidth>
inline __attribute__((always_inline)) void ExpandAll(const std::vector<Group>& groups,
                                                     double anchor_s, std::size_t n_sums,
                                                     double* coefficients) {
  for (const Group& group : groups) Expand<kWidth>(group, anchor_s, n_sums, coefficients);
}

__attribute__((target("avx512f"))) void ExpandWithAvx512(const std::vector<Group>& groups,
                                                         double anchor_s, std::size_t n_sums,
                                                         double* coefficients) {
  ExpandAll<8>(groups, anchor_s, n_sums, coefficients);
}

__attribute__((target("avx2"))) void ExpandWithAvx2(const std::vector<Group>& groups,
                                                    double anchor_s, std::size_t n_sums,
                                                    double* coefficients) {
  ExpandAll<4>(groups, anchor_s, n_sums, coefficients);
}

void ExpandWithSse2(const std::vector<Group>& groups, double anchor_s, std::size_t n_sums,
                    double* coefficients) {
  ExpandAll<2>(groups, anchor_s, n_sums, coefficients);
}

// Adds every line at `t_s` to its sums, in the same order whatever the width.
template <std::size_t kWidth>
inline __attribute__((always_inline)) void AddLines(const std::vector<Group>& groups, double t_s,
                                                    double* values) {
  using Vector = typename VectorOf<kWidth>::Type;
  std::array<double, kMaxLines> cosines, sines;
  for (const Group& group : groups) {
    const std::size_t n_lines = group.frequencies_hz.size();
    CosSinAt<kWidth>(t_s, group.frequencies_hz, cosines.data(), sines.data());
    const double *a_of = group.amplitudes.data(), *b_of = a_of + n_lines;
    for (const std::size_t sum : group.sums) {
      std::array<double, kLanes> lanes;
      for (std::size_t offset = 0; offset < kLanes; offset += kWidth) {
        Vector total{};
        for (std::size_t i = offset; i < n_lines; i += kLanes) {
          Vector a, b, cos, sin;
          Load(a_of + i, &a);
          Load(b_of + i, &b);
          Load(&cosines[i], &cos);
          Load(&sines[i], &sin);
          total += a * cos + b * sin;
        }
        Store(total, &lanes[offset]);
      }
      Lanes all;
      Load(lanes.data(), &all);
      values[sum] += Sum(all);
      a_of += 2 * n_lines;
      b_of += 2 * n_lines;
    }
  }
}

__attribute__((target("avx512f"))) void AddLinesWithAvx512(const std::vector<Group>& groups,
                                                           double t_s, double* values) {
  AddLines<8>(groups, t_s, values);
}

__attribute__((target("avx2"))) void AddLinesWithAvx2(const std::vector<Group>& groups, double t_s,
                                                      double* values) {
  AddLines<4>(groups, t_s, values);
}

constexpr std::size_t WholeBlocks(std::size_t n) { return (n + kLanes - 1) / kLanes * kLanes; }

bool SameLines(const Sinusoids& signal, std::size_t begin, const std::vector<double>& hz) {
  if (std::min(signal.size() - begin, kMaxLines) != hz.size()) return false;
  for (std::size_t i = 0; i < hz.size(); ++i) {
    if (signal[begin + i].frequency_hz != hz[i]) return false;
  }
  return true;
}

// The lines from `begin` on, and lines of no amplitude up to a whole block.
void AddAmplitudes(const Sinusoids& signal, std::size_t begin, Group* group) {
  const std::size_t n_lines = group->frequencies_hz.size(), n_all = WholeBlocks(n_lines);
  const std::size_t at = group->amplitudes.size();
  group->amplitudes.resize(at + 2 * n_all, 0);
  for (std::size_t i = 0; i < n_lines; ++i) {
    const Sinusoid& line = signal[begin + i];
    group->amplitudes[at + i] = line.amplitude * std::cos(line.phase_rad);
    group->amplitudes[at + n_all + i] = -line.amplitude * std::sin(line.phase_rad);
  }
}

}  // namespace

AnchoredSums::AnchoredSums(const std::vector<Sinusoids>& sums)
    : n_sums_(sums.size()), n_padded_(WholeBlocks(sums.size())) {
  double highest_hz = 0;
  for (std::size_t k = 0; k < sums.size(); ++k) {
    for (std::size_t begin = 0; begin < sums[k].size(); begin += kMaxLines) {
      auto group = std::find_if(groups_.begin(), groups_.end(), [&](const Group& other) {
        return SameLines(sums[k], begin, other.frequencies_hz);
      });
      if (group == groups_.end()) {
        group = groups_.emplace(groups_.end());
        const std::size_t end = std::min(sums[k].size(), begin + kMaxLines);
        for (std::size_t i = begin; i < end; ++i) {
          group->frequencies_hz.push_back(sums[k][i].frequency_hz);
          highest_hz = std::max(highest_hz, std::abs(sums[k][i].frequency_hz));
        }
      }
      group->sums.push_back(k);
      AddAmplitudes(sums[k], begin, &*group);
    }
  }
  if (highest_hz > 0) spacing_s_ = kMaxAngle_rad / (std::numbers::pi * highest_hz);
  for (Group& group : groups_) {
    group.frequencies_hz.resize(WholeBlocks(group.frequencies_hz.size()), 0);
    for (const double f : group.frequencies_hz) {
      const double angle_rad = std::numbers::pi * f * spacing_s_;
      group.angles_rad.push_back(angle_rad);
      group.squares_rad2.push_back(angle_rad * angle_rad);
    }
  }
}

void AnchoredSums::Expand(double anchor_s, InstructionSet instructions, Series* series) const {
  series->anchor_s = anchor_s;
  series->coefficients.assign(kTerms * n_padded_, 0);
  double* const coefficients = series->coefficients.data();
  if (instructions == InstructionSet::kAvx512) {
    ExpandWithAvx512(groups_, anchor_s, n_padded_, coefficients);
  } else if (instructions == InstructionSet::kAvx2) {
    ExpandWithAvx2(groups_, anchor_s, n_padded_, coefficients);
  } else {
    ExpandWithSse2(groups_, anchor_s, n_padded_, coefficients);
  }
  for (std::size_t n = 0; n < kTerms; ++n) {
    for (std::size_t k = 0; k < n_padded_; ++k) coefficients[n * n_padded_ + k] *= kFactors[n];
  }
}

void AnchoredSums::At(double t_s, InstructionSet instructions, Series* series,
                      double* values) const {
  const double anchor_s = std::nearbyint(t_s / spacing_s_) * spacing_s_;
  if (series->anchor_s != anchor_s) Expand(anchor_s, instructions, series);
  const double tau = (t_s - anchor_s) * (2 / spacing_s_);
  for (std::size_t k = 0; k < n_sums_; k += kLanes) {
    const double* coefficients = &series->coefficients[(kTerms - 1) * n_padded_ + k];
    Lanes value, next;
    Load(coefficients, &value);
    for (std::size_t n = 1; n < kTerms; ++n) {
      Load(coefficients -= n_padded_, &next);
      value = value * tau + next;
    }
    std::memcpy(&values[k], &value, std::min(kLanes, n_sums_ - k) * sizeof(double));
  }
}

void AnchoredSums::AtAlone(double t_s, InstructionSet instructions, double* values) const {
  std::fill_n(values, n_sums_, 0.0);
  if (instructions == InstructionSet::kAvx512) {
    AddLinesWithAvx512(groups_, t_s, values);
  } else if (instructions == InstructionSet::kAvx2) {
    AddLinesWithAvx2(groups_, t_s, values);
  } else {
    AddLines<2>(groups_, t_s, values);
  }
}

}  // namespace windhover
