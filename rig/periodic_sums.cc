#include "rig/periodic_sums.h"

#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/LU>
#include <unsupported/Eigen/FFT>

#include "rig/lanes.h"

namespace windhover {
namespace {

static_assert(PeriodicSums::kMaxSums == kLanes);

constexpr double kPi = std::numbers::pi;
constexpr std::size_t kMinLines = 256, kMaxHarmonic = 1 << 18;

// The window: I0(β √(1 - (2 z / W)²)) / I0(β) for entries z away, |z| < W / 2. Lines lie below a
// quarter of a turn per entry, their images above three quarters: β = 3/4 π W puts those beyond
// the window's main lobe.
constexpr std::size_t kWidth = 16;
constexpr double kBeta = 0.75 * kPi * kWidth;

double Window(double z) {
  const double edge = 1 - std::pow(2 * z / kWidth, 2);
  return edge < 0 ? 0 : std::cyl_bessel_i(0, kBeta * std::sqrt(edge)) / std::cyl_bessel_i(0, kBeta);
}

// ∫ Window(z) cos(2π ξ z) dz. @pre |ξ| < 0.75
double WindowSpectrum(double turns_per_entry) {
  const double x = std::sqrt(kBeta * kBeta - std::pow(kPi * kWidth * turns_per_entry, 2));
  return kWidth * std::sinh(x) / (x * std::cyl_bessel_i(0, kBeta));
}

// The window at each of the 16 entries about a place, as a polynomial of the place between the
// middle two, -1 to 1. The window is an entire function that grows at most as exp(4.7 |z|): over
// half an entry the Chebyshev series' first term left out is 2 I19(2.4) = 4e-16 of its largest
// value.
class Weights {
 public:
  Weights() {
    Eigen::Matrix<double, kTerms, kTerms> powers;
    Eigen::Matrix<double, kTerms, kWidth> samples;
    for (int i = 0; i < kTerms; ++i) {
      const double place = std::cos(kPi * (i + 0.5) / kTerms);
      for (int n = 0; n < kTerms; ++n) powers(i, n) = std::pow(place, n);
      for (int j = 0; j < static_cast<int>(kWidth); ++j) {
        samples(i, j) = Window(place / 2 + 0.5 + kWidth / 2 - 1 - j);
      }
    }
    polynomials_ = powers.partialPivLu().solve(samples);
  }

  void At(double place, std::array<Lanes, 2>* weights) const {
    const double* coefficients = polynomials_.row(kTerms - 1).data();
    for (std::size_t half = 0; half < 2; ++half) {
      Load(coefficients + half * kLanes, &(*weights)[half]);
    }
    for (int n = 1; n < kTerms; ++n) {
      coefficients -= kWidth;
      for (std::size_t half = 0; half < 2; ++half) {
        Lanes next;
        Load(coefficients + half * kLanes, &next);
        (*weights)[half] = (*weights)[half] * place + next;
      }
    }
  }

 private:
  static constexpr int kTerms = 19;
  Eigen::Matrix<double, kTerms, kWidth, Eigen::RowMajor> polynomials_;
};

const Weights& TheWeights() {
  static const Weights weights;
  return weights;
}

}  // namespace

std::optional<Harmonics> HarmonicsOf(const Sinusoids& signal) {
  if (signal.size() < kMinLines) return std::nullopt;
  const double first_hz = signal.front().frequency_hz, last_hz = signal.back().frequency_hz;
  const double n = static_cast<double>(signal.size() - 1);
  const double first = std::round(first_hz * n / (last_hz - first_hz));
  if (!(first >= 1 && first + n < kMaxHarmonic)) return std::nullopt;
  const double fundamental_hz = last_hz / (first + n);
  for (std::size_t i = 0; i < signal.size(); ++i) {
    const double expected_hz = (first + static_cast<double>(i)) * fundamental_hz;
    const double rounding_hz = 1e-15 * expected_hz;
    if (!(std::abs(signal[i].frequency_hz - expected_hz) <= rounding_hz)) return std::nullopt;
  }
  return Harmonics{fundamental_hz, static_cast<std::size_t>(first)};
}

PeriodicSums::PeriodicSums(const Harmonics& harmonics, const std::vector<Sinusoids>& sums)
    : fundamental_hz_(harmonics.fundamental_hz) {
  const std::size_t n = std::bit_ceil(4 * (harmonics.first + sums.front().size()));
  n_entries_ = static_cast<double>(n);
  constexpr std::size_t kBefore = kWidth / 2;
  table_.assign((n + 2 * kBefore) * kLanes, 0);
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::Unscaled);
  std::vector<std::complex<double>> spectrum(n), entries;
  for (std::size_t sum = 0; sum < sums.size(); ++sum) {
    for (std::size_t i = 0; i < sums[sum].size(); ++i) {
      const std::size_t k = harmonics.first + i;
      const double gain = 1 / WindowSpectrum(static_cast<double>(k) / n_entries_);
      spectrum[k] = std::polar(gain, sums[sum][i].phase_rad) * sums[sum][i].amplitude;
    }
    fft.inv(entries, spectrum);
    for (std::size_t row = 0; row < n + 2 * kBefore; ++row) {
      table_[row * kLanes + sum] = entries[(row + n - kBefore) % n].real();
    }
  }
}

void PeriodicSums::At(double t_s, double* values) const {
  const double turns = fundamental_hz_ * t_s;
  const double entry = (turns - std::floor(turns)) * n_entries_;
  const double whole = std::floor(entry);
  std::array<Lanes, 2> weights;
  TheWeights().At(2 * (entry - whole) - 1, &weights);
  // The entry 7 before the one at or before the moment, of a table that begins 8 before its first.
  const double* row = &table_[(static_cast<std::size_t>(whole) + 1) * kLanes];
  Lanes sum{};
  for (std::size_t j = 0; j < kWidth; ++j, row += kLanes) {
    Lanes entries;
    Load(row, &entries);
    sum += entries * weights[j / kLanes][j % kLanes];
  }
  Store(sum, values);
}

}  // namespace windhover
