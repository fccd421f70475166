#include "sweep/quadratic_surface.h"

#include <cmath>
#include <set>

#include <Eigen/QR>

namespace windhover {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The columns of the model, with their names.
class Model {
 public:
  Model(const MatrixXd& x, const std::vector<std::string>& names) {
    const MatrixXd coded = 2 * x.array() - 1;
    Add("1", VectorXd::Ones(x.rows()));
    const auto name = [&](Index i) { return names[static_cast<std::size_t>(i)]; };
    for (Index i = 0; i < x.cols(); ++i) Add(name(i), coded.col(i));
    for (Index i = 0; i < x.cols(); ++i) {
      for (Index j = i + 1; j < x.cols(); ++j) {
        Add(name(i) + " · " + name(j), coded.col(i).cwiseProduct(coded.col(j)));
      }
      const std::set<double> levels(x.col(i).begin(), x.col(i).end());
      if (levels.size() > 2) Add(name(i) + "²", coded.col(i).cwiseAbs2());
    }
  }

  const std::vector<std::string>& names() const { return names_; }

  MatrixXd Columns() const {
    MatrixXd all(columns_.front().size(), static_cast<Index>(columns_.size()));
    for (std::size_t i = 0; i < columns_.size(); ++i) all.col(static_cast<Index>(i)) = columns_[i];
    return all;
  }

 private:
  void Add(const std::string& name, const VectorXd& column) {
    names_.push_back(name);
    columns_.push_back(column);
  }

  std::vector<std::string> names_;
  std::vector<VectorXd> columns_;
};

}  // namespace

QuadraticSurface FitQuadraticSurface(const MatrixXd& x, const VectorXd& y,
                                     const std::vector<std::string>& names) {
  QuadraticSurface surface;
  const Model model(x, names);
  const MatrixXd columns = model.Columns();
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(columns);
  if (columns.rows() <= columns.cols() || qr.rank() < columns.cols()) return surface;
  const VectorXd coefficients = qr.solve(y);
  const VectorXd residuals = y - columns * coefficients;
  const double total = (y.array() - y.mean()).square().sum();
  surface.r_squared = total > 0 ? 1 - residuals.squaredNorm() / total : 1;
  // Each point's weight in its own prediction (hat matrix) tells what it is without it.
  const MatrixXd q = qr.householderQ() * MatrixXd::Identity(columns.rows(), columns.cols());
  const Eigen::ArrayXd leverage = q.rowwise().squaredNorm();
  surface.leave_one_out_rmse =
      std::sqrt((residuals.array() / (1 - leverage).max(1e-9)).square().mean());
  for (std::size_t i = 0; i < model.names().size(); ++i) {
    surface.terms.push_back({model.names()[i], coefficients[static_cast<Index>(i)]});
  }
  return surface;
}

}  // namespace windhover
