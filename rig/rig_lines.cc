#include "rig/rig_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace windhover {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

}  // namespace

RigLines::RigLines(std::array<Sinusoids, kSize> sums, double line_spacing_hz)
    : sums_(std::move(sums)), line_spacing_hz_(line_spacing_hz) {
  largest_.setZero();
  largest_curvature_.setZero();
  for (int s = 0; s < kSize; ++s) {
    for (const Sinusoid& line : sums_[s]) {
      const double rate_radps = kTwoPi * line.frequency_hz;
      largest_[s] += std::abs(line.amplitude);
      largest_curvature_[s] += std::abs(line.amplitude) * rate_radps * rate_radps;
    }
  }
  if (line_spacing_hz_ > 0) StoreHarmonics();
}

bool RigLines::empty() const { return largest_.isZero(0); }

void RigLines::StoreHarmonics() {
  const auto harmonic = [&](const Sinusoid& line) {
    return static_cast<int>(std::lround(line.frequency_hz / line_spacing_hz_));
  };
  int last = 0;
  first_harmonic_ = std::numeric_limits<int>::max();
  for (const Sinusoids& sum : sums_) {
    for (const Sinusoid& line : sum) {
      first_harmonic_ = std::min(first_harmonic_, harmonic(line));
      last = std::max(last, harmonic(line));
    }
  }
  const int n_blocks = std::max(0, last - first_harmonic_ + kBlock) / kBlock;
  for (int s = 0; s < kSize; ++s) {
    cosine_[s].assign(n_blocks * kBlock, 0);
    sine_[s].assign(n_blocks * kBlock, 0);
    for (const Sinusoid& line : sums_[s]) {
      cosine_[s][harmonic(line) - first_harmonic_] = line.amplitude * std::cos(line.phase_rad);
      sine_[s][harmonic(line) - first_harmonic_] = line.amplitude * std::sin(line.phase_rad);
    }
  }
}

RigLines::Vector RigLines::At(double t_s) const {
  if (line_spacing_hz_ > 0) return AtHarmonics(t_s);
  Vector sum;
  for (int s = 0; s < kSize; ++s) sum[s] = Value(sums_[s], t_s);
  return sum;
}

RigLines::Vector RigLines::AtHarmonics(double t_s) const {
  const double turns = line_spacing_hz_ * t_s;  // Of the first harmonic, since t = 0.
  std::array<double, kBlock> cos_in_block, sin_in_block;
  for (int i = 0; i < kBlock; ++i) {
    cos_in_block[i] = std::cos(kTwoPi * (i * turns));
    sin_in_block[i] = std::sin(kTwoPi * (i * turns));
  }
  std::array<std::array<double, kBlock>, kSize> sums{};
  const int n = static_cast<int>(cosine_[0].size());
  for (int begin = 0; begin < n; begin += kBlock) {
    const double start_rad = kTwoPi * ((first_harmonic_ + begin) * turns);
    const double cos_start = std::cos(start_rad), sin_start = std::sin(start_rad);
    std::array<double, kBlock> c, s;
    for (int i = 0; i < kBlock; ++i) {
      c[i] = cos_start * cos_in_block[i] - sin_start * sin_in_block[i];
      s[i] = sin_start * cos_in_block[i] + cos_start * sin_in_block[i];
    }
    for (int k = 0; k < kSize; ++k) {
      const double* const a = &cosine_[k][begin];
      const double* const b = &sine_[k][begin];
      for (int i = 0; i < kBlock; ++i) sums[k][i] += a[i] * c[i] - b[i] * s[i];
    }
  }
  Vector out = Vector::Zero();
  for (int k = 0; k < kSize; ++k) {
    for (const double partial : sums[k]) out[k] += partial;
  }
  return out;
}

}  // namespace windhover
