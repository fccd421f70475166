#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace windhover {

/// Regression by a Gaussian process with a constant mean and the kernel
/// s² exp(−½ Σ ((x_i − x'_i)/l_i)²). s, every l_i and a noise beside the given ones are those of
/// the largest marginal likelihood that a compass search finds.
/// Source: C. E. Rasmussen and C. K. I. Williams, "Gaussian Processes for Machine Learning", 2006,
/// algorithm 2.1, equations 2.30 and 5.12.
class GaussianProcess {
 public:
  /// @param x one point a row, coordinates in [0, 1]; @param y as many values;
  /// @param noise_sigma their standard errors. At least two points.
  GaussianProcess(Eigen::MatrixXd x, const Eigen::VectorXd& y, Eigen::VectorXd noise_sigma);

  struct Prediction {
    double mean, sigma;  ///< Of the response without noise.
  };
  Prediction At(const Eigen::VectorXd& x) const;
  double MeanAt(const Eigen::VectorXd& x) const;

  /// Root of the mean square error of each point predicted from the others, with the same s, l.
  double leave_one_out_rmse() const { return leave_one_out_rmse_; }

  const Eigen::VectorXd& length_scales() const { return length_; }

 private:
  /// Natural logarithms of l_i, s and noise, these two in standard deviations of y.
  void Take(const Eigen::VectorXd& parameters);
  Eigen::MatrixXd Covariance(const Eigen::MatrixXd& x, const Eigen::VectorXd& noise) const;
  Eigen::VectorXd KernelAt(const Eigen::VectorXd& x) const;
  void Fit();
  void Condition();

  Eigen::MatrixXd x_;
  Eigen::VectorXd y_, noise_;  ///< In standard deviations of y, about its mean.
  double mean_ = 0, scale_ = 1;
  Eigen::VectorXd length_;
  double signal_ = 1, nugget_ = 0;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::VectorXd weights_;
  double leave_one_out_rmse_ = 0;
};

}  // namespace windhover
