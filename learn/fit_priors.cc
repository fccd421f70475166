#include "learn/fit_priors.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "estimator/box_geometry.h"

namespace windhover {
namespace {

constexpr std::size_t kLeastTuples = 20;  // Of a flight.
constexpr int kRounds = 30;
constexpr double kHuber = 1.5;       // Standard deviations that weigh in full.
constexpr double kToSigma = 1.4826;  // Median absolute deviation of a normal distribution.

struct Sample {
  BoxGeometry geometry;
  double label_m;
  Utime utime;
};
using Flight = std::vector<Sample>;

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double RobustSigma(std::vector<double> errors) {
  for (double& error : errors) error = std::abs(error);
  return kToSigma * Median(std::move(errors));
}

double Mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

/// Unbiased standard deviation.
double Spread(const std::vector<double>& values) {
  const double mean = Mean(values);
  double squares = 0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

std::vector<Flight> FlightsOf(std::span<const StereoTuple> tuples, const StereoRig& rig,
                              double offset_px) {
  std::vector<Flight> flights;
  for (std::size_t i = 0; i < tuples.size(); ++i) {
    const StereoTuple& tuple = tuples[i];
    const auto geometry = GeometryOf(rig, tuple.box, offset_px);
    if (!geometry || !(tuple.range_m > 0) || !std::isfinite(tuple.range_m)) {
      throw std::invalid_argument(fmt::format("tuple {} has no rays or no label", i));
    }
    if (i == 0 || tuple.flight != tuples[i - 1].flight) flights.emplace_back();
    flights.back().push_back({*geometry, tuple.range_m, tuple.utime});
  }
  std::erase_if(flights, [](const Flight& flight) { return flight.size() < kLeastTuples; });
  if (flights.size() < kLeastFlights) {
    throw std::invalid_argument(fmt::format("{} flights of {} tuples are needed (found {})",
                                            kLeastFlights, kLeastTuples, flights.size()));
  }
  return flights;
}

/// Weighted least squares of `y` by `A` with Huber's weights.
Eigen::VectorXd RobustFit(const Eigen::MatrixXd& A, const Eigen::VectorXd& y) {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(y.size());
  Eigen::VectorXd solution;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::MatrixXd weighted = weights.asDiagonal() * A;
    solution = (A.transpose() * weighted).ldlt().solve(weighted.transpose() * y);
    const Eigen::VectorXd errors = y - A * solution;
    const double sigma = RobustSigma({errors.begin(), errors.end()}) + 1e-12;
    weights = (kHuber * sigma / errors.array().abs().max(kHuber * sigma)).matrix();
  }
  return solution;
}

struct Calibration {
  double offset_px, excess_m;
};

/// disparity = f B / ((d - excess) cos θ) + offset, by Gauss-Newton. Rows are weighted by the
/// inverse width, as noise grows with it.
Calibration CalibrationOf(const Flight& flight, double focal_baseline_px_m) {
  const auto n = static_cast<Eigen::Index>(flight.size());
  Calibration found{0, 0};
  for (int round = 0; round < kRounds; ++round) {
    Eigen::MatrixXd A(n, 2);
    Eigen::VectorXd y(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto& [geometry, label_m, utime] = flight[static_cast<std::size_t>(i)];
      const double range_m = std::max(label_m - found.excess_m, label_m / 2);
      const double parallax_px = focal_baseline_px_m / (range_m * geometry.cosine);
      const double weight = 1 / std::hypot(50, geometry.width_px);
      A.row(i) << weight, weight * parallax_px / range_m;
      y(i) = weight * (geometry.disparity_px - parallax_px);
    }
    const Eigen::VectorXd step = RobustFit(A, y);
    found.offset_px = step(0);
    found.excess_m += step(1);
    if (std::abs(step(1)) < 1e-9) break;
  }
  return found;
}

/// x[i-1] - 2 x[i] + x[i+1] over √6, which of white noise keeps the standard deviation.
template <typename Value, typename Function>
void ForEachSecondDifference(const Flight& flight, const Value& value, const Function& f) {
  for (std::size_t i = 1; i + 1 < flight.size(); ++i) {
    const Utime before = flight[i].utime - flight[i - 1].utime;
    if (flight[i + 1].utime - flight[i].utime != before) continue;
    f(flight[i],
      (value(flight[i - 1]) - 2 * value(flight[i]) + value(flight[i + 1])) / std::sqrt(6.0));
  }
}

/// Fits |error| of box widths: σ² = constant² + (relative · w)².
void FitDisparityNoise(const std::vector<Flight>& flights, FittedPriors* priors) {
  std::vector<std::pair<double, double>> by_width;
  for (const Flight& flight : flights) {
    ForEachSecondDifference(
        flight, [](const Sample& s) { return s.geometry.disparity_px; },
        [&](const Sample& s, double e) { by_width.emplace_back(s.geometry.width_px, e); });
  }
  std::sort(by_width.begin(), by_width.end());
  constexpr std::size_t kBins = 8;
  const std::size_t n = by_width.size() / kBins;
  if (n < kLeastTuples) throw std::invalid_argument("too few successive tuples to tell noise");
  Eigen::MatrixXd A(kBins, 2);
  Eigen::VectorXd y(kBins);
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    std::vector<double> errors;
    for (std::size_t i = bin * n; i < (bin + 1) * n; ++i) errors.push_back(by_width[i].second);
    const double variance = std::pow(RobustSigma(errors), 2);
    const double width_px = by_width[bin * n + n / 2].first;
    // A variance's own error is proportional to it.
    A.row(static_cast<Eigen::Index>(bin)) << 1 / variance, width_px * width_px / variance;
    y(static_cast<Eigen::Index>(bin)) = 1;
  }
  const Eigen::VectorXd squares = (A.transpose() * A).ldlt().solve(A.transpose() * y);
  priors->disparity_sigma_px = std::sqrt(std::max(squares(0), 1e-4));
  priors->disparity_sigma_relative = std::sqrt(std::max(squares(1), 0.0));
}

void FitSize(const std::vector<Flight>& flights, FittedPriors* priors) {
  std::size_t n = 0;
  for (const Flight& flight : flights) n += flight.size();
  Eigen::MatrixXd A(n, 3);
  Eigen::VectorXd y(n);
  Eigen::Index row = 0;
  for (const Flight& flight : flights) {
    for (const Sample& s : flight) {
      A.row(row) << 1, std::log(s.geometry.width), std::log(s.geometry.height);
      y(row++) = std::log(s.label_m * s.geometry.cosine);
    }
  }
  const Eigen::VectorXd solution = RobustFit(A, y);
  priors->size_log_m = solution(0);
  priors->width_exponent = solution(1);
  priors->height_exponent = solution(2);
}

/// Splits the error of sizes into what stays in a flight, what drifts and the rest.
void FitSizeNoise(const std::vector<Flight>& flights, FittedPriors* priors) {
  const auto error = [&](const Sample& s) {
    return std::log(s.label_m * s.geometry.cosine) - priors->size_log_m -
           priors->width_exponent * std::log(s.geometry.width) -
           priors->height_exponent * std::log(s.geometry.height);
  };
  std::vector<double> all, within, white, biases;
  for (const Flight& flight : flights) {
    std::vector<double> errors;
    for (const Sample& s : flight) errors.push_back(error(s));
    biases.push_back(Median(errors));
    for (const double e : errors) all.push_back(e), within.push_back(e - biases.back());
    ForEachSecondDifference(flight, error, [&](const Sample&, double e) { white.push_back(e); });
  }
  const double within_sigma = RobustSigma(within), white_sigma = RobustSigma(white);
  priors->size_bias_sigma = Spread(biases);
  priors->size_drift_sigma =
      std::sqrt(std::max(within_sigma * within_sigma - white_sigma * white_sigma, 1e-6));
  priors->size_sigma = std::sqrt(std::pow(priors->size_bias_sigma, 2) +
                                 std::pow(priors->size_drift_sigma, 2) + white_sigma * white_sigma);
}

/// Offset and lever over all flights, from where priors->offset_px is; takes from the labels what
/// is peculiar to their flight.
void FitRig(double focal_baseline_px_m, std::vector<Flight>* flights, FittedPriors* priors) {
  std::vector<double> offsets_px, excesses_m;
  for (const Flight& flight : *flights) {
    const Calibration found = CalibrationOf(flight, focal_baseline_px_m);
    offsets_px.push_back(found.offset_px);
    excesses_m.push_back(found.excess_m);
  }
  priors->offset_px += Median(offsets_px);
  priors->offset_sigma_px = Spread(offsets_px);
  priors->lever_m = Mean(excesses_m);
  for (std::size_t i = 0; i < flights->size(); ++i) {
    for (Sample& s : (*flights)[i]) {
      s.label_m = std::max(s.label_m - excesses_m[i] + priors->lever_m, s.label_m / 2);
    }
  }
}

}  // namespace

FittedPriors FitPriors(std::span<const StereoTuple> tuples, const StereoRig& rig) {
  FittedPriors priors;
  std::vector<Flight> flights;
  // Twice, as the offset is taken away before lenses are undistorted.
  for (int pass = 0; pass < 2; ++pass) {
    flights = FlightsOf(tuples, rig, priors.offset_px);
    FitRig(rig.left.fx_px() * rig.baseline_m, &flights, &priors);
  }
  FitDisparityNoise(flights, &priors);
  FitSize(flights, &priors);
  FitSizeNoise(flights, &priors);
  return priors;
}

}  // namespace windhover
