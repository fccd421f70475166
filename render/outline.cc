#include "render/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "rig/lanes.h"

namespace windhover {
namespace {

constexpr double kSteep = 0.5, kSmall = 0.01;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Points {
  const double *x_m, *y_m, *z_m;
  std::size_t n;  ///< Whole lanes.
};

// The least and the largest so far; what is not a number is passed over.
template <typename Vector>
inline __attribute__((always_inline)) void Keep(const Vector& value, Vector* low, Vector* high) {
  *low = value < *low ? value : *low;
  *high = value > *high ? value : *high;
}

template <typename Vector, typename Function>
inline __attribute__((always_inline)) bool All(const Vector& values, const Function& holds) {
  bool all = true;
  for (std::size_t i = 0; i < sizeof(Vector) / sizeof(double); ++i) all &= holds(values[i]);
  return all;
}

// PinholeRadtan::Project of all points, operation by operation, and the box around them; false if
// it takes more than that to know whether the lens sees one. Radial terms have the derivatives
// radius' and radius / r, both at least kSteep here; tangential ones change them by at most
// 8 r (|p1| + |p2|), below a third of that: the image does not fold.
template <std::size_t kWidth>
inline __attribute__((always_inline)) bool FindBox(const Points& points, const PinholeRadtan& m,
                                                   const Eigen::Isometry3d& X_CB,
                                                   Eigen::AlignedBox2d* box) {
  using Vector = typename VectorOf<kWidth>::Type;
  if (std::abs(m.p1) + std::abs(m.p2) > kSmall) return false;
  const auto& X = X_CB.matrix();
  const double falls_a = std::min(21 * m.k3, 0.0) / 3, falls_b = std::min(10 * m.k2, 0.0) / 2,
               falls_c = std::min(3 * m.k1, 0.0);
  Vector low_u = Vector{} + kInfinity, low_v = low_u, high_u = -low_u, high_v = -low_u;
  // Of all points, to be judged at the end: comparisons of vectors cost more than all the rest.
  Vector nearest_m = low_u, least_slope = low_u, widest = high_u, total{};
  for (std::size_t i = 0; i < points.n; i += kWidth) {
    Vector x_B, y_B, z_B;
    Load(points.x_m + i, &x_B);
    Load(points.y_m + i, &y_B);
    Load(points.z_m + i, &z_B);
    const Vector depth = X(2, 0) * x_B + X(2, 1) * y_B + X(2, 2) * z_B + X(2, 3);
    const Vector x = (X(0, 0) * x_B + X(0, 1) * y_B + X(0, 2) * z_B + X(0, 3)) / depth;
    const Vector y = (X(1, 0) * x_B + X(1, 1) * y_B + X(1, 2) * z_B + X(1, 3)) / depth;
    const Vector r2 = x * x + y * y;
    const Vector radial = 1 + r2 * (m.k1 + r2 * (m.k2 + r2 * m.k3));
    const Vector slope = 1 + r2 * (falls_c + r2 * (falls_b + r2 * falls_a));
    const Vector u = m.fx_px * (x * radial + 2 * m.p1 * x * y + m.p2 * (r2 + 2 * x * x)) + m.cx_px;
    const Vector v = m.fy_px * (y * radial + m.p1 * (r2 + 2 * y * y) + 2 * m.p2 * x * y) + m.cy_px;
    Keep(u, &low_u, &high_u);
    Keep(v, &low_v, &high_v);
    nearest_m = depth < nearest_m ? depth : nearest_m;
    least_slope = slope < least_slope ? slope : least_slope;
    widest = r2 > widest ? r2 : widest;
    total += u + v;
  }
  if (!All(nearest_m, [](double z_m) { return z_m >= PinholeRadtan::kMinDepth_m; }) ||
      !All(least_slope, [](double slope) { return slope > kSteep; }) ||
      !All(widest, [](double r2) { return r2 < 4; }) ||
      !All(total, [](double sum) { return std::isfinite(sum); })) {
    return false;
  }
  for (std::size_t i = 0; i < kWidth; ++i) {
    box->extend(Eigen::Vector2d(low_u[i], low_v[i]));
    box->extend(Eigen::Vector2d(high_u[i], high_v[i]));
  }
  return true;
}

__attribute__((target("avx512f,avx512dq"))) bool FindBoxWithAvx512(const Points& points,
                                                                   const PinholeRadtan& model,
                                                                   const Eigen::Isometry3d& X_CB,
                                                                   Eigen::AlignedBox2d* box) {
  return FindBox<8>(points, model, X_CB, box);
}

__attribute__((target("avx2"))) bool FindBoxWithAvx2(const Points& points,
                                                     const PinholeRadtan& model,
                                                     const Eigen::Isometry3d& X_CB,
                                                     Eigen::AlignedBox2d* box) {
  return FindBox<4>(points, model, X_CB, box);
}

bool FindBoxWithSse2(const Points& points, const PinholeRadtan& model,
                     const Eigen::Isometry3d& X_CB, Eigen::AlignedBox2d* box) {
  return FindBox<2>(points, model, X_CB, box);
}

}  // namespace

Outline::Outline(const std::vector<Eigen::Vector3d>& points_B_m) : n_points_(points_B_m.size()) {
  for (std::size_t i = 0; i < (n_points_ + kLanes - 1) / kLanes * kLanes; ++i) {
    const Eigen::Vector3d& p_B = points_B_m[std::min(i, n_points_ - 1)];
    x_m_.push_back(p_B.x());
    y_m_.push_back(p_B.y());
    z_m_.push_back(p_B.z());
  }
}

Eigen::AlignedBox2d Outline::BoxThrough(const AnyCamera& camera, const RowPoses& X_CB,
                                        InstructionSet instructions) const {
  const PinholeRadtan* const model = camera.Visit([](const auto& any) -> const PinholeRadtan* {
    if constexpr (std::is_same_v<std::decay_t<decltype(any)>, PinholeRadtan>) {
      return &any;
    } else {
      return nullptr;
    }
  });
  Eigen::AlignedBox2d box;
  if (model != nullptr && X_CB.IsOne() && n_points_ > 0) {
    const Points points{x_m_.data(), y_m_.data(), z_m_.data(), x_m_.size()};
    const auto find = instructions == InstructionSet::kAvx512 ? FindBoxWithAvx512
                      : instructions == InstructionSet::kAvx2 ? FindBoxWithAvx2
                                                              : FindBoxWithSse2;
    if (find(points, *model, X_CB.X_CB[0], &box)) return box;
    box.setEmpty();
  }
  for (std::size_t i = 0; i < n_points_; ++i) {
    const Eigen::Vector3d p_B(x_m_[i], y_m_[i], z_m_[i]);
    if (const auto q_px = ProjectByRows(camera, X_CB, p_B)) box.extend(*q_px);
  }
  return box;
}

}  // namespace windhover
