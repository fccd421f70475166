#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace windhover {

/// A response on a regular grid over two coded coordinates: values(i, j) at x = i/(rows − 1),
/// y = j/(cols − 1).
struct ResponseMap {
  Eigen::MatrixXd values;
};

ResponseMap MakeMap(int n_x, int n_y, const std::function<double(double x, double y)>& f);

/// A piece of a contour: x, y of both ends, coded.
using ContourSegment = std::array<double, 4>;

/// Where the map has the value `level`: marching squares, linear along edges. Saddles are parted by
/// the mean of their corners.
std::vector<ContourSegment> ContourOf(const ResponseMap& map, double level);

/// Largest x up to which f stays at most `limit`; nothing if it is above at 0, 1 if it never is.
/// f is looked at in `n` steps; between two of them it is taken as linear.
std::optional<double> LargestWithin(const std::function<double(double x)>& f, double limit, int n);

}  // namespace windhover
