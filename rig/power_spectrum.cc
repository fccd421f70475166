#include "rig/power_spectrum.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "common/table/number_table.h"

namespace windhover {
namespace {

using Breakpoint = PowerSpectrum::Breakpoint;

// Mean square between two frequencies of the segment from `a` to `b`, where
// S(f) = S_a (f / f_a)^n.
double SegmentPower_g2(const Breakpoint& a, const Breakpoint& b, double from_hz, double to_hz) {
  const double low_hz = std::max(from_hz, a.frequency_hz);
  const double high_hz = std::min(to_hz, b.frequency_hz);
  if (low_hz >= high_hz) return 0;
  const double n = std::log(b.g2_per_hz / a.g2_per_hz) / std::log(b.frequency_hz / a.frequency_hz);
  const double low = std::log(low_hz / a.frequency_hz), high = std::log(high_hz / a.frequency_hz);
  const double scale = a.g2_per_hz * a.frequency_hz;
  // ∫ S df = S_a f_a ∫ exp((n + 1) u) du with u = ln(f / f_a).
  const double m = n + 1;
  if (std::abs(m) * (high - low) < 1e-12) return scale * std::exp(m * low) * (high - low);
  return scale * std::exp(m * low) * std::expm1(m * (high - low)) / m;
}

}  // namespace

PowerSpectrum::PowerSpectrum(std::vector<Breakpoint> breakpoints)
    : breakpoints_(std::move(breakpoints)) {}

PowerSpectrum PowerSpectrum::SmallMultirotorFloor() {
  return PowerSpectrum({{10, 5e-4}, {30, 2e-3}, {200, 2e-3}, {500, 3.2e-4}});
}

PowerSpectrum PowerSpectrum::MilStd810hCategory24() {
  return PowerSpectrum({{20, 0.04}, {1000, 0.04}, {2000, 0.01}});  // -6 dB an octave.
}

PowerSpectrum PowerSpectrum::FromFile(const std::string& file) {
  FileFindings findings(file);
  const NumberTable table = ReadNumberTable(file, 2, /*more_allowed=*/false, &findings);
  std::vector<Breakpoint> breakpoints;
  for (const auto& [line, values] : table.rows) {
    const Breakpoint point{values[0], values[1]};
    if (!(point.frequency_hz > 0)) {
      findings.Add(line, fmt::format("f_hz: must be > 0 (found {})", point.frequency_hz));
    } else if (!breakpoints.empty() && point.frequency_hz <= breakpoints.back().frequency_hz) {
      findings.Add(line, fmt::format("f_hz: must rise from line to line (found {} after {})",
                                     point.frequency_hz, breakpoints.back().frequency_hz));
    } else if (!(point.g2_per_hz > 0)) {
      findings.Add(line, fmt::format("g2_per_hz: must be > 0 (found {})", point.g2_per_hz));
    } else {
      breakpoints.push_back(point);
    }
  }
  if (findings.empty() && breakpoints.size() < 2) {
    findings.Add(
        fmt::format("must have at least 2 lines of f_hz,g2_per_hz (found {})", breakpoints.size()));
  }
  findings.ThrowIfAny();
  return PowerSpectrum(std::move(breakpoints));
}

double PowerSpectrum::Power_g2(double from_hz, double to_hz) const {
  double sum = 0;
  for (std::size_t i = 1; i < breakpoints_.size(); ++i) {
    sum += SegmentPower_g2(breakpoints_[i - 1], breakpoints_[i], from_hz, to_hz);
  }
  return sum;
}

Sinusoids PowerSpectrum::Synthesize(double from_hz, int n_bins, RandomStream stream) const {
  const double low_hz = std::max(from_hz, breakpoints_.front().frequency_hz);
  const double ratio = breakpoints_.back().frequency_hz / low_hz;
  Sinusoids signal;
  if (ratio <= 1) return signal;
  const auto edge_hz = [&](double k) { return low_hz * std::pow(ratio, k / n_bins); };
  for (int k = 0; k < n_bins; ++k) {
    const double begin_hz = edge_hz(k), end_hz = edge_hz(k + 1);
    const double power_g2 = Power_g2(begin_hz, end_hz);
    signal.push_back({.frequency_hz = stream.Uniform(begin_hz, end_hz),
                      .amplitude = kStandardGravity_mps2 * std::sqrt(2 * power_g2),
                      .phase_rad = stream.Uniform(0, 2 * std::numbers::pi)});
  }
  return signal;
}

}  // namespace windhover
