#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace windhover {

/// The classic response surface: y = b_0 + Σ b_i x_i + Σ b_ij x_i x_j + Σ b_ii x_i², by least
/// squares, x coded to [−1, 1]. Source: G. E. P. Box and K. B. Wilson, J. R. Stat. Soc. B 13
/// (1951).
struct QuadraticSurface {
  struct Term {
    std::string name;  ///< "1", "a", "a · b", "a²".
    double coefficient;
  };
  std::vector<Term> terms;
  double r_squared = 0;
  double leave_one_out_rmse = 0;
};

/// @param x one point a row, coordinates in [0, 1]; @param y as many values; @param names of the
/// coordinates. The square of a coordinate with two values only is left out.
/// @return no terms if there are not more points than those.
QuadraticSurface FitQuadraticSurface(const Eigen::MatrixXd& x, const Eigen::VectorXd& y,
                                     const std::vector<std::string>& names);

}  // namespace windhover
