#include "rig/sinusoid_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

namespace windhover {
namespace {

using Group = SinusoidSums::Group;

constexpr std::size_t kLanes = 8;
constexpr std::size_t kMaxSums = 16;

// Eight numbers; the compiler makes of them what the processor has.
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));

inline __attribute__((always_inline)) void Load(const double* from, Lanes* lanes) {
  std::memcpy(lanes, from, sizeof(Lanes));
}

// cos and sin of 2π `turns`, to 1e-13: Taylor series of a quarter of the angle, which is below
// π/4, whose next terms are 2e-14 and 1e-15; twice doubled. Adding and taking away 1.5 · 2^52
// rounds to whole turns.
inline __attribute__((always_inline)) void CosSin(const Lanes& turns, Lanes* cos, Lanes* sin) {
  constexpr double kRound = 0x1.8p52;
  const Lanes part = turns - ((turns + kRound) - kRound);
  const Lanes x = part * (std::numbers::pi / 2), x2 = x * x;
  Lanes s = x2 * (1.0 / 6227020800) - 1.0 / 39916800;
  Lanes c = x2 * (-1.0 / 87178291200) + 1.0 / 479001600;
  s = s * x2 + 1.0 / 362880;
  c = c * x2 - 1.0 / 3628800;
  s = s * x2 - 1.0 / 5040;
  c = c * x2 + 1.0 / 40320;
  s = s * x2 + 1.0 / 120;
  c = c * x2 - 1.0 / 720;
  s = s * x2 - 1.0 / 6;
  c = c * x2 + 1.0 / 24;
  s = x + x * (s * x2);
  c = c * x2 - 0.5;
  c = c * x2 + 1.0;
  const Lanes two_s = s + s, c2 = 1.0 - two_s * s, two_s2 = 2.0 * (two_s * c);
  *sin = two_s2 * c2;
  *cos = 1.0 - 0.5 * two_s2 * two_s2;
}

template <std::size_t kSums>
inline __attribute__((always_inline)) void AddLines(const Group& group, double t_s,
                                                    std::size_t n_sums, double* values) {
  const std::size_t n = kSums > 0 ? kSums : n_sums;  // Known when compiled, or not.
  std::array<Lanes, kSums == 0 ? kMaxSums : kSums> sums{};
  const double* amplitudes = group.amplitudes.data();
  for (std::size_t i = 0; i < group.frequencies_hz.size(); i += kLanes) {
    Lanes frequency_hz, cos, sin;
    Load(&group.frequencies_hz[i], &frequency_hz);
    CosSin(frequency_hz * t_s, &cos, &sin);
    for (std::size_t k = 0; k < n; ++k, amplitudes += 2 * kLanes) {
      Lanes a, b;
      Load(amplitudes, &a);
      Load(amplitudes + kLanes, &b);
      sums[k] += a * cos + b * sin;
    }
  }
  for (std::size_t k = 0; k < n; ++k) {
    double sum = 0;
    for (std::size_t lane = 0; lane < kLanes; ++lane) sum += sums[k][lane];
    values[group.sums[k]] = sum;
  }
}

inline __attribute__((always_inline)) void AddGroup(const Group& group, double t_s,
                                                    double* values) {
  if (group.sums.size() == 1) return AddLines<1>(group, t_s, 1, values);
  if (group.sums.size() == 2) return AddLines<2>(group, t_s, 2, values);
  if (group.sums.size() == 8) return AddLines<8>(group, t_s, 8, values);
  AddLines<0>(group, t_s, group.sums.size(), values);
}

bool SameFrequencies(const Sinusoids& signal, const std::vector<double>& frequencies_hz) {
  if (signal.size() != frequencies_hz.size()) return false;
  for (std::size_t i = 0; i < signal.size(); ++i) {
    if (signal[i].frequency_hz != frequencies_hz[i]) return false;
  }
  return true;
}

// Lays out the lines of `group.sums`, with lines of no amplitude up to a whole block.
void StoreLines(const std::vector<Sinusoids>& sums, Group* group) {
  const std::size_t n_lines = (group->frequencies_hz.size() + kLanes - 1) / kLanes * kLanes;
  const std::size_t n_sums = group->sums.size();
  group->frequencies_hz.resize(n_lines, 0);
  group->amplitudes.assign(2 * n_lines * n_sums, 0);
  for (std::size_t k = 0; k < n_sums; ++k) {
    const Sinusoids& signal = sums[group->sums[k]];
    for (std::size_t i = 0; i < signal.size(); ++i) {
      const std::size_t at = 2 * kLanes * (i / kLanes * n_sums + k) + i % kLanes;
      group->amplitudes[at] = signal[i].amplitude * std::cos(signal[i].phase_rad);
      group->amplitudes[at + kLanes] = -signal[i].amplitude * std::sin(signal[i].phase_rad);
    }
  }
}

}  // namespace

SinusoidSums::SinusoidSums(const std::vector<Sinusoids>& sums) : n_sums_(sums.size()) {
  for (std::size_t k = 0; k < sums.size(); ++k) {
    if (sums[k].empty()) continue;
    const auto same = std::find_if(groups_.begin(), groups_.end(), [&](const Group& group) {
      return group.sums.size() < kMaxSums && SameFrequencies(sums[k], group.frequencies_hz);
    });
    if (same != groups_.end()) {
      same->sums.push_back(k);
      continue;
    }
    Group& group = groups_.emplace_back();
    for (const Sinusoid& line : sums[k]) group.frequencies_hz.push_back(line.frequency_hz);
    group.sums.push_back(k);
  }
  for (Group& group : groups_) StoreLines(sums, &group);
}

__attribute__((target("avx512f"))) void SinusoidSums::AtWithAvx512(double t_s,
                                                                   double* values) const {
  std::fill_n(values, n_sums_, 0.0);
  for (const Group& group : groups_) AddGroup(group, t_s, values);
}

__attribute__((target("avx2"))) void SinusoidSums::AtWithAvx2(double t_s, double* values) const {
  std::fill_n(values, n_sums_, 0.0);
  for (const Group& group : groups_) AddGroup(group, t_s, values);
}

void SinusoidSums::AtWithSse2(double t_s, double* values) const {
  std::fill_n(values, n_sums_, 0.0);
  for (const Group& group : groups_) AddGroup(group, t_s, values);
}

void SinusoidSums::At(double t_s, double* values) const {
  static const bool has_avx512 = __builtin_cpu_supports("avx512f") != 0;
  static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
  if (has_avx512) return AtWithAvx512(t_s, values);
  if (has_avx2) return AtWithAvx2(t_s, values);
  AtWithSse2(t_s, values);
}

}  // namespace windhover
