#include "render/projected_mesh.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace windhover {
namespace {

constexpr double kNear_m = 0.05;
constexpr std::size_t kBatch = 64;

// Vertices [first, first + count) one by one.
template <typename Camera>
void ProjectEach(const Mesh& mesh, const Camera& camera, const RowPoses& X_CB, std::size_t first,
                 std::size_t count, ProjectedMesh* projected) {
  for (std::size_t i = first; i < first + count; ++i) {
    Eigen::Vector3d p_C;
    const auto q_px = ProjectByRows(camera, X_CB, mesh.positions[i].cast<double>(), &p_C);
    const bool is_seen = q_px && p_C.z() > kNear_m;
    projected->x_px[i] = is_seen ? q_px->x() : 0;
    projected->y_px[i] = is_seen ? q_px->y() : 0;
    projected->inverse_depth_per_m[i] = is_seen ? 1 / p_C.z() : 0;
  }
}

struct Batch {
  float p_B[3][kBatch];
  double x_px[kBatch], y_px[kBatch], inverse_depth[kBatch];
};

struct BatchPose {
  double R[9], t[3];  // Row by row.
};

// PinholeRadtan::Project for many points at once. Returns false if it might have no answer for one
// of them: by the bound with which GrowsUntil there begins, or by the distortion's determinant.
[[gnu::always_inline]] inline bool ProjectBatch(const PinholeRadtan m, const BatchPose pose,
                                                Batch* batch) {
  const double c = std::min(3 * m.k1, 0.0), b = std::min(10 * m.k2, 0.0) / 2,
               a = std::min(21 * m.k3, 0.0) / 3;
  const double *R = pose.R, *t = pose.t;
  double worst[kBatch];
  for (std::size_t i = 0; i < kBatch; ++i) {
    const double px = batch->p_B[0][i], py = batch->p_B[1][i], pz = batch->p_B[2][i];
    const double depth_m = R[6] * px + R[7] * py + R[8] * pz + t[2], inverse = 1 / depth_m;
    const double x = (R[0] * px + R[1] * py + R[2] * pz + t[0]) * inverse;
    const double y = (R[3] * px + R[4] * py + R[5] * pz + t[1]) * inverse;
    const double r2 = x * x + y * y;
    const double radial = 1 + r2 * (m.k1 + r2 * (m.k2 + r2 * m.k3));
    const double slope = m.k1 + r2 * (2 * m.k2 + r2 * 3 * m.k3);
    batch->x_px[i] = m.fx_px * (x * radial + 2 * m.p1 * x * y + m.p2 * (r2 + 2 * x * x)) + m.cx_px;
    batch->y_px[i] = m.fy_px * (y * radial + m.p1 * (r2 + 2 * y * y) + 2 * m.p2 * x * y) + m.cy_px;
    batch->inverse_depth[i] = inverse;
    const double shear = 2 * x * y * slope + 2 * m.p1 * x + 2 * m.p2 * y;
    const double dx = radial + 2 * x * x * slope + 2 * m.p1 * y + 6 * m.p2 * x;
    const double dy = radial + 2 * y * y * slope + 6 * m.p1 * y + 2 * m.p2 * x;
    const double grows = 1 + r2 * (c + r2 * (b + r2 * a)), turns = dx * dy - shear * shear;
    const double is_near = depth_m - kNear_m;
    const double least = grows < turns ? grows : turns;
    worst[i] = is_near < least ? is_near : least;
  }
  bool all = true;
  for (std::size_t i = 0; i < kBatch; ++i) all &= worst[i] > 0;
  return all;
}

bool ProjectSse2(const PinholeRadtan& m, const BatchPose& pose, Batch* batch) {
  return ProjectBatch(m, pose, batch);
}
__attribute__((target("avx2"))) bool ProjectAvx2(const PinholeRadtan& m, const BatchPose& pose,
                                                 Batch* batch) {
  return ProjectBatch(m, pose, batch);
}
__attribute__((target("avx512f,avx512vl,avx512bw,avx512dq"))) bool ProjectAvx512(
    const PinholeRadtan& m, const BatchPose& pose, Batch* batch) {
  return ProjectBatch(m, pose, batch);
}

void ProjectPinhole(const Mesh& mesh, const PinholeRadtan& camera, const RowPoses& X_CB,
                    InstructionSet isa, ProjectedMesh* projected) {
  const auto project = isa == InstructionSet::kAvx512 ? ProjectAvx512
                       : isa == InstructionSet::kAvx2 ? ProjectAvx2
                                                      : ProjectSse2;
  BatchPose pose;
  const Eigen::Isometry3d& X = X_CB.Middle();
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(pose.R) = X.linear();
  Eigen::Map<Eigen::Vector3d>(pose.t) = X.translation();
  const std::size_t n = mesh.positions.size();
  Batch batch;
  for (std::size_t first = 0; first < n; first += kBatch) {
    const std::size_t count = std::min(kBatch, n - first);
    for (std::size_t i = 0; i < kBatch; ++i) {
      const Eigen::Vector3f& p_B = mesh.positions[first + std::min(i, count - 1)];
      for (int axis = 0; axis < 3; ++axis) batch.p_B[axis][i] = p_B[axis];
    }
    if (!project(camera, pose, &batch)) {
      ProjectEach(mesh, camera, X_CB, first, count, projected);
      continue;
    }
    std::copy_n(batch.x_px, count, projected->x_px.data() + first);
    std::copy_n(batch.y_px, count, projected->y_px.data() + first);
    std::copy_n(batch.inverse_depth, count, projected->inverse_depth_per_m.data() + first);
  }
}

// Bounds of the triangles that are seen, and which these are.
void FindSeen(const Mesh& mesh, ProjectedMesh* out) {
  const auto extend = [out](std::size_t i) {
    out->bounds.Extend(out->x_px[i], out->y_px[i], out->inverse_depth_per_m[i]);
  };
  const std::vector<double>& inverse = out->inverse_depth_per_m;
  if (std::all_of(inverse.begin(), inverse.end(), [](double v) { return v > 0; })) {
    out->all = &mesh.triangles;
    for (std::size_t i = 0; i < inverse.size(); ++i) extend(i);
    return;
  }
  for (const auto& t : mesh.triangles) {
    if (!(inverse[t[0]] > 0 && inverse[t[1]] > 0 && inverse[t[2]] > 0)) continue;
    out->seen.push_back(t);
    for (const std::uint32_t i : t) extend(i);
  }
}

}  // namespace

ProjectedMesh Project(const Mesh& mesh, const AnyCamera& camera, const RowPoses& X_CB,
                      InstructionSet isa) {
  ProjectedMesh projected;
  const std::size_t n = mesh.positions.size();
  projected.x_px.resize(n);
  projected.y_px.resize(n);
  projected.inverse_depth_per_m.resize(n);
  camera.Visit([&](const auto& model) {
    if constexpr (std::is_same_v<std::decay_t<decltype(model)>, PinholeRadtan>) {
      if (X_CB.IsOne()) return ProjectPinhole(mesh, model, X_CB, isa, &projected);
    }
    ProjectEach(mesh, model, X_CB, 0, n, &projected);
  });
  FindSeen(mesh, &projected);
  return projected;
}

void ImageBounds::Extend(double x_px, double y_px, double inverse_depth) {
  x_min = std::min(x_min, x_px);
  x_max = std::max(x_max, x_px);
  y_min = std::min(y_min, y_px);
  y_max = std::max(y_max, y_px);
  inverse_near = std::max(inverse_near, inverse_depth);
  inverse_far = std::min(inverse_far, inverse_depth);
}

void ImageBounds::Extend(const ImageBounds& other) {
  x_min = std::min(x_min, other.x_min);
  x_max = std::max(x_max, other.x_max);
  y_min = std::min(y_min, other.y_min);
  y_max = std::max(y_max, other.y_max);
  inverse_near = std::max(inverse_near, other.inverse_near);
  inverse_far = std::min(inverse_far, other.inverse_far);
}

void ImageBounds::Grow(double margin_px) {
  x_min -= margin_px;
  y_min -= margin_px;
  x_max += margin_px;
  y_max += margin_px;
}

double ImageBounds::Extent_px() const { return std::max(x_max - x_min, y_max - y_min); }

PixelRect ImageBounds::Within(int width_px, int height_px, int margin_px) const {
  if (x_min > x_max) return {};
  // From the first to the last pixel, as far as `size` pixels and the margins reach.
  const auto range = [margin_px](double low, double high, int size) {
    const double first = -margin_px, last = size + margin_px - 1;
    return std::array{static_cast<int>(std::floor(std::clamp(low, first, last + 1) + 0.5)),
                      static_cast<int>(std::floor(std::clamp(high, first - 1, last) + 0.5))};
  };
  const auto [x0, x1] = range(x_min, x_max, width_px);
  const auto [y0, y1] = range(y_min, y_max, height_px);
  return {x0, y0, x1 - x0 + 1, y1 - y0 + 1};
}

}  // namespace windhover
