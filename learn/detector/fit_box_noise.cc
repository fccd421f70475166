#include "learn/detector/fit_box_noise.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <stdexcept>

namespace windhover {
namespace {

constexpr std::size_t kMinSamples = 50;
constexpr double kGross = 3.5;  // Deviations: 1 in 2,000 normal errors is beyond.
constexpr int kRounds = 30;

/// One normal variable as often as it was observed.
struct Errors {
  double error, size;
};

struct Pair {
  Errors left, right;
};

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Deviation of a normal variable whose absolute value has this median.
double DeviationOf(const std::vector<double>& absolute) { return 1.4826 * Median(absolute); }

/// One coordinate of both images, of all samples that have errors.
std::vector<Pair> PairsOf(const std::vector<BoxErrorSample>& samples,
                          double BoxErrors::OneImage::*value, std::size_t side) {
  std::vector<Pair> pairs;
  for (const BoxErrorSample& sample : samples) {
    if (!sample.errors) continue;
    pairs.push_back({{sample.errors->left.*value, sample.sizes[0][side]},
                     {sample.errors->right.*value, sample.sizes[1][side]}});
  }
  return pairs;
}

template <typename T>
std::vector<T> Joined(std::vector<T> a, const std::vector<T>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Variance: constant + slope · size².
struct Variance {
  double constant, slope;
  double At(double size) const { return constant + slope * size * size; }
  /// In deviations.
  double Share(const Errors& e) const { return e.error / std::sqrt(At(e.size)); }
};

/// Least squares of error² with the weights of its own variance, both terms at least 0.
Variance Regressed(const std::vector<Errors>& errors, const Variance& before) {
  double n = 0, s = 0, ss = 0, e = 0, es = 0;
  for (const Errors& one : errors) {
    const double variance = before.At(one.size), weight = 1 / (variance * variance);
    const double size = one.size * one.size, square = one.error * one.error;
    n += weight;
    s += weight * size;
    ss += weight * size * size;
    e += weight * square;
    es += weight * size * square;
  }
  const double determinant = n * ss - s * s;
  const double constant = (e * ss - es * s) / determinant, slope = (es * n - e * s) / determinant;
  const bool is_regular = determinant > 1e-12 * n * ss;
  if (!is_regular || slope < 0) return {e / n, 0};
  if (constant < 0) return {0, es / ss};
  return {constant, slope};
}

/// Of those within 3.5 deviations, by maximum likelihood.
Variance VarianceOf(const std::vector<Errors>& all) {
  std::vector<double> absolute;
  for (const Errors& one : all) absolute.push_back(std::abs(one.error));
  const double first = std::max(1e-3, DeviationOf(absolute));
  Variance variance{first * first, 0};
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Errors> inside;
    std::copy_if(all.begin(), all.end(), std::back_inserter(inside),
                 [&](const Errors& one) { return std::abs(variance.Share(one)) <= kGross; });
    variance = Regressed(inside, variance);
    variance.constant = std::max(variance.constant, 1e-6);  // A thousandth is nothing.
  }
  return variance;
}

std::vector<Errors> Split(const std::vector<Pair>& pairs) {
  std::vector<Errors> all;
  for (const Pair& pair : pairs) all.insert(all.end(), {pair.left, pair.right});
  return all;
}

/// How much more one image errs than the other, in deviations of one image, and the size which
/// that depends on.
std::vector<Errors> Differences(const std::vector<Pair>& pairs, const Variance& variance,
                                bool depends_on_size) {
  std::vector<Errors> differences;
  for (const Pair& pair : pairs) {
    const double size = depends_on_size ? (pair.left.size + pair.right.size) / 2 : 0;
    differences.push_back({variance.Share(pair.left) - variance.Share(pair.right), size});
  }
  return differences;
}

/// Gross is what one image errs in x and the other does not: what both err alike moves no
/// distance, nor does y, which errs grossly in other pairs.
void FitGross(const std::vector<Pair>& x, const std::vector<Errors>& differences,
              const Variance& of_differences, GeometricConfig* fitted) {
  int n_gross = 0;
  double squares = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::abs(of_differences.Share(differences[i])) <= kGross) continue;
    ++n_gross;
    squares += std::pow(x[i].left.error / x[i].left.size - x[i].right.error / x[i].right.size, 2);
  }
  // Either of the two images may be the one, or both.
  const auto n = static_cast<double>(x.size());
  fitted->gross_rate = 1 - std::sqrt(1 - n_gross / n);
  const double n_images = 2 * n * fitted->gross_rate;
  if (n_gross > 0) fitted->gross_sigma = std::min(10.0, std::sqrt(squares / n_images));
}

/// How alike both images err, and how often they do not.
void FitPairs(const std::vector<Pair>& x, const std::vector<Pair>& y, const Variance& variance,
              GeometricConfig* fitted) {
  const auto differences_x = Differences(x, variance, /*depends_on_size=*/true);
  const auto differences_y = Differences(y, variance, /*depends_on_size=*/false);
  // 2 - 2 correlation, and for x that times (width / correlation_width_px)² more.
  const Variance of_differences = VarianceOf(Joined(differences_x, differences_y));
  fitted->correlation = std::clamp(1 - of_differences.constant / 2, -0.99, 0.99);
  if (of_differences.slope > 0) {
    const double own = 2 - 2 * fitted->correlation;
    fitted->correlation_width_px = std::min(1e4, std::sqrt(own / of_differences.slope));
  }
  FitGross(x, differences_x, of_differences, fitted);
}

double SizeFactor(const std::vector<Pair>& pairs, const Variance& variance) {
  std::vector<double> absolute;
  for (const Errors& one : Split(pairs)) absolute.push_back(std::abs(variance.Share(one)));
  return std::min(10.0, DeviationOf(absolute));
}

/// Targets whose narrower boxes are about as wide.
struct WidthBin {
  double n = 0, n_missed = 0, width_px = 0;
};

std::vector<WidthBin> WidthBins(const std::vector<BoxErrorSample>& samples) {
  constexpr double kBinsPerUnit = 50;  // Of the width's logarithm: 2 % each.
  std::map<int, WidthBin> bins;
  for (const BoxErrorSample& sample : samples) {
    const double width_px = std::max(0.1, std::min(sample.sizes[0][0], sample.sizes[1][0]));
    const auto number = static_cast<int>(std::lround(kBinsPerUnit * std::log(width_px)));
    WidthBin& bin = bins[number];
    bin.width_px = std::exp(number / kBinsPerUnit);
    ++bin.n;
    if (!sample.errors) ++bin.n_missed;
  }
  std::vector<WidthBin> list;
  for (const auto& [number, bin] : bins) list.push_back(bin);
  return list;
}

double MissLikelihood(const std::vector<WidthBin>& bins, const GeometricConfig& config) {
  double sum = 0;
  for (const WidthBin& bin : bins) {
    const double missed = std::clamp(MissProbability(config, bin.width_px), 1e-6, 1 - 1e-6);
    sum += bin.n_missed * std::log(missed) + (bin.n - bin.n_missed) * std::log(1 - missed);
  }
  return sum;
}

/// The best of a grid around `fitted`'s misses, `step` apart in powers of e.
void SearchMisses(const std::vector<WidthBin>& bins, double step, int reach,
                  GeometricConfig* fitted) {
  const GeometricConfig middle = *fitted;
  double best = MissLikelihood(bins, middle);
  const auto factor = [&](int i) { return std::exp(step * i); };
  for (int i = -reach; i <= reach; ++i) {
    for (int k = -reach; k <= reach; ++k) {
      for (int l = -reach; l <= reach; ++l) {
        GeometricConfig config = middle;
        config.miss_rate = std::min(1.0, middle.miss_rate * factor(i));
        config.miss_width_px = std::min(1000.0, middle.miss_width_px * factor(k));
        config.miss_softness_px = std::clamp(middle.miss_softness_px * factor(l), 0.01, 1000.0);
        const double likelihood = MissLikelihood(bins, config);
        if (likelihood <= best) continue;
        best = likelihood;
        *fitted = config;
      }
    }
  }
}

void FitMisses(const std::vector<BoxErrorSample>& samples, GeometricConfig* fitted) {
  const std::vector<WidthBin> bins = WidthBins(samples);
  double n = 0, n_missed = 0;
  for (const WidthBin& bin : bins) {
    n += bin.n;
    n_missed += bin.n_missed;
  }
  fitted->miss_rate = n_missed / n;
  fitted->miss_width_px = 0;
  if (n_missed == 0) return;
  GeometricConfig with_width = *fitted;
  with_width.miss_rate /= 4;
  with_width.miss_width_px = 20;
  with_width.miss_softness_px = 4;
  for (double step = 0.4; step > 0.005; step /= 2) {
    for (int round = 0; round < 4; ++round) SearchMisses(bins, step, /*reach=*/3, &with_width);
  }
  // Three numbers must explain much more than one does (Akaike).
  if (MissLikelihood(bins, with_width) > MissLikelihood(bins, *fitted) + 2) *fitted = with_width;
}

}  // namespace

GeometricConfig FitBoxNoise(const std::vector<BoxErrorSample>& samples) {
  using One = BoxErrors::OneImage;
  const std::vector<Pair> x = PairsOf(samples, &One::x, 0), y = PairsOf(samples, &One::y, 1);
  if (x.size() < kMinSamples) {
    throw std::invalid_argument("a noise model needs 50 targets that were found");
  }
  const Variance variance = VarianceOf(Split(Joined(x, y)));
  GeometricConfig fitted;
  fitted.sigma_px = std::sqrt(variance.constant);
  fitted.sigma_relative = std::sqrt(variance.slope);
  fitted.size_factor =
      SizeFactor(Joined(PairsOf(samples, &One::w, 0), PairsOf(samples, &One::h, 1)), variance);
  FitPairs(x, y, variance, &fitted);
  FitMisses(samples, &fitted);
  return fitted;
}

}  // namespace windhover
