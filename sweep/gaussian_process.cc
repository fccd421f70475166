#include "sweep/gaussian_process.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace windhover {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Of many points these are enough to learn lengths from; the cost goes with the cube.
constexpr Index kMostToFit = 250;
constexpr double kJitter = 1e-8;
// Lengths beyond these say "constant" and "independent"; noise below 1e-4 deviations is none.
constexpr double kLongest = 20, kShortest = 0.03, kLeastNoise = 1e-4;

/// Every k-th row, at most `most` of them.
template <typename Matrix>
Matrix Thinned(const Matrix& all, Index most) {
  const Index step = (all.rows() + most - 1) / most;
  Matrix rows((all.rows() + step - 1) / step, all.cols());
  for (Index i = 0; i < rows.rows(); ++i) rows.row(i) = all.row(i * step);
  return rows;
}

/// Smallest f near `x`: steps along each axis, halved when none helps (R. Hooke and T. A. Jeeves,
/// J. ACM 8(2), 1961, without pattern moves).
template <typename Function>
VectorXd CompassSearch(const Function& f, VectorXd x) {
  double best = f(x);
  for (double step = 1; step > 0.03; step /= 2) {
    for (bool improved = true; improved;) {
      improved = false;
      for (Index i = 0; i < x.size(); ++i) {
        for (const double sign : {1.0, -1.0}) {
          VectorXd next = x;
          next[i] += sign * step;
          const double value = f(next);
          if (!(value < best - 1e-6)) continue;
          best = value;
          x = next;
          improved = true;
        }
      }
    }
  }
  return x;
}

}  // namespace

GaussianProcess::GaussianProcess(MatrixXd x, const VectorXd& y, VectorXd noise_sigma)
    : x_(std::move(x)) {
  mean_ = y.mean();
  const double variance = (y.array() - mean_).square().mean();
  scale_ = variance > 0 ? std::sqrt(variance) : 1;
  y_ = (y.array() - mean_) / scale_;
  noise_ = noise_sigma / scale_;
  Fit();
  Condition();
}

void GaussianProcess::Take(const VectorXd& parameters) {
  const Index d = x_.cols();
  length_ = parameters.head(d).array().exp().max(kShortest).min(kLongest);
  signal_ = std::exp(parameters[d]);
  nugget_ = std::max(std::exp(parameters[d + 1]), kLeastNoise);
}

MatrixXd GaussianProcess::Covariance(const MatrixXd& x, const VectorXd& noise) const {
  const MatrixXd scaled = x * length_.cwiseInverse().asDiagonal();
  const VectorXd norms = scaled.rowwise().squaredNorm();
  MatrixXd squared = -2 * scaled * scaled.transpose();
  squared.colwise() += norms;
  squared.rowwise() += norms.transpose();
  MatrixXd covariance = signal_ * signal_ * (-0.5 * squared.array().max(0)).exp().matrix();
  covariance.diagonal().array() += noise.array().square() + nugget_ * nugget_ + kJitter;
  return covariance;
}

void GaussianProcess::Fit() {
  const MatrixXd x = Thinned(x_, kMostToFit);
  const VectorXd y = Thinned(y_, kMostToFit), noise = Thinned(noise_, kMostToFit);
  const auto minus_log_likelihood = [&](const VectorXd& parameters) {
    Take(parameters);
    const Eigen::LLT<MatrixXd> factor(Covariance(x, noise));
    if (factor.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
    const double log_determinant = factor.matrixLLT().diagonal().array().log().sum();
    return 0.5 * y.dot(factor.solve(y)) + log_determinant;
  };
  VectorXd start = VectorXd::Zero(x_.cols() + 2);
  start.head(x_.cols()).setConstant(std::log(0.5));
  start[x_.cols() + 1] = std::log(0.05);
  Take(CompassSearch(minus_log_likelihood, start));
}

void GaussianProcess::Condition() {
  factor_.compute(Covariance(x_, noise_));
  weights_ = factor_.solve(y_);
  const MatrixXd inverse = factor_.solve(MatrixXd::Identity(x_.rows(), x_.rows()));
  const Eigen::ArrayXd errors = weights_.array() / inverse.diagonal().array();
  leave_one_out_rmse_ = scale_ * std::sqrt(errors.square().mean());
}

VectorXd GaussianProcess::KernelAt(const VectorXd& x) const {
  const MatrixXd difference = (x_.rowwise() - x.transpose()) * length_.cwiseInverse().asDiagonal();
  return signal_ * signal_ * (-0.5 * difference.rowwise().squaredNorm().array()).exp();
}

double GaussianProcess::MeanAt(const VectorXd& x) const {
  return mean_ + scale_ * KernelAt(x).dot(weights_);
}

GaussianProcess::Prediction GaussianProcess::At(const VectorXd& x) const {
  const VectorXd kernel = KernelAt(x);
  const double variance = signal_ * signal_ - factor_.matrixL().solve(kernel).squaredNorm();
  return {mean_ + scale_ * kernel.dot(weights_), scale_ * std::sqrt(std::max(variance, 0.0))};
}

}  // namespace windhover
