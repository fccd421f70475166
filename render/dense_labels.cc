#include "render/dense_labels.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <Eigen/LU>
#include <fmt/format.h>

#include "common/image/image_file.h"
#include "render/motion.h"
#include "render/raster_mesh.h"

namespace windhover {
namespace {

constexpr std::size_t kMaxAircraft = 254;

struct Eye {
  const RowCameras& cameras;
  DenseLabels::View* view;
};

// Edges that appear no longer than 40 px, as in PreparedModel, but no finer than the eye sees.
Mesh BodyFor(const AircraftShape& shape, double range_m, double focal_px) {
  constexpr double kMaxEdge_px = 40, kFinest = 0.015;
  const double nearest_m = std::max(range_m - shape.radius_m, 0.05);
  const double max_edge_m = std::max(kMaxEdge_px * nearest_m / focal_px, kFinest * shape.radius_m);
  return WithShortEdges(shape.model.body, static_cast<float>(max_edge_m));
}

// The depth of a mesh at the centres of the pixels of `region`; 0 where it is not.
std::vector<float> DepthOf(const ProjectedMesh& mesh, Faces faces, const PixelRect& region) {
  RasterMesh raster;
  raster.Set(mesh, faces, mesh.bounds, 1);
  SampleTile tile{.x0 = region.x0,
                  .y0 = region.y0,
                  .width = region.width,
                  .height = region.height,
                  .stride = (region.width + 2 * SampleTile::kPadding - 1) & -SampleTile::kPadding};
  std::vector<float> nearness(static_cast<std::size_t>(tile.stride * tile.height));
  std::vector<std::uint32_t> nearest(nearness.size());
  tile.nearness = nearness.data();
  tile.nearest = nearest.data();
  DrawOpaque(WidestInstructionSet(), raster.Vertices(), raster.Triangles(), tile);
  std::vector<float> depth_m;
  for (int y = 0; y < region.height; ++y) {
    for (int x = 0; x < region.width; ++x) {
      const auto at = static_cast<std::size_t>(y * tile.stride + x);
      const double inverse = raster.InverseDepthAt(nearness[at]);
      depth_m.push_back(nearest[at] == 0 ? 0 : static_cast<float>(1 / inverse));
    }
  }
  return depth_m;
}

void DrawInto(const AircraftShape& shape, const Mesh& body, const RowPoses& X_CB,
              std::uint8_t label, int width_px, int height_px, const Eye& eye) {
  const ProjectedMesh mesh = Project(body, eye.cameras.camera, X_CB);
  const PixelRect region = mesh.bounds.Within(width_px, height_px, 0);
  if (region.IsEmpty()) return;
  const std::vector<float> depth_m =
      DepthOf(mesh, shape.model.watertight ? Faces::kFront : Faces::kBoth, region);
  for (int y = 0; y < region.height; ++y) {
    for (int x = 0; x < region.width; ++x) {
      const float here_m = depth_m[static_cast<std::size_t>(y * region.width + x)];
      const auto at = static_cast<std::size_t>((region.y0 + y) * width_px + region.x0 + x);
      float& nearest_m = eye.view->depth_m[at];
      if (here_m == 0 || (nearest_m > 0 && nearest_m <= here_m)) continue;
      nearest_m = here_m;
      eye.view->mask[at] = label;
    }
  }
}

// The point of a body that row `row` sees at `p_C_m`.
Eigen::Vector3d InBody(const RowPoses& X_CB, double row, const Eigen::Vector3d& p_C_m) {
  if (X_CB.IsOne()) return X_CB.Middle().inverse() * p_C_m;
  const Eigen::Vector3d origin = X_CB.PointAt(row, Eigen::Vector3d::Zero());
  Eigen::Matrix3d axes;
  for (int i = 0; i < 3; ++i) axes.col(i) = X_CB.PointAt(row, Eigen::Vector3d::Unit(i)) - origin;
  return axes.inverse() * (p_C_m - origin);
}

float DisparityAt(int x, int y, double depth_m, const AnyCamera& left, const RowPoses& X_LB,
                  const AnyCamera& right, const RowPoses& X_RB) {
  const auto ray_C = left.Unproject({static_cast<double>(x), static_cast<double>(y)});
  if (!ray_C) return 0;
  const Eigen::Vector3d p_B_m = InBody(X_LB, y, *ray_C * (depth_m / ray_C->z()));
  const auto q_px = ProjectByRows(right, X_RB, p_B_m);
  return q_px ? static_cast<float>(x - q_px->x()) : 0;
}

}  // namespace

DenseLabels MakeDenseLabels(const Scenario& scenario, int observer, const world_truth_t& world) {
  return MakeDenseLabels(scenario, SceneGeometry(scenario, {observer}), 0, world);
}

DenseLabels MakeDenseLabels(const Scenario& scenario, const SceneGeometry& geometry,
                            std::size_t observer, const world_truth_t& world) {
  if (scenario.aircraft.size() > kMaxAircraft) {
    throw ConfigError(fmt::format("dense labels: at most {} aircraft (found {})", kMaxAircraft,
                                  scenario.aircraft.size()));
  }
  geometry.CheckWorld(world);
  const ObserverRig& rig = geometry.Observers()[observer];
  const auto [width_px, height_px] = scenario.rig.calibrated.image;
  const double nominal_s = scenario.exposure.duration_ms * 1e-3;
  const StereoRowCameras cameras =
      CamerasByRows(world, rig.position, rig.X_BR, rig.motion,
                    geometry.ShutterOf(world, observer, nominal_s, nominal_s), height_px, 0);
  DenseLabels labels{width_px, height_px, {}, {}, {}};
  const auto n = static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px);
  labels.left = labels.right = {std::vector<float>(n), std::vector<std::uint8_t>(n)};
  labels.disparity_px.resize(n);
  std::vector<RowPoses> X_LB(world.uavs.size()), X_RB(world.uavs.size());
  for (std::size_t i = 0; i < world.uavs.size(); ++i) {
    if (i == rig.position) continue;
    X_LB[i] = PosesOf(cameras.left, world.uavs[i]);
    X_RB[i] = PosesOf(cameras.right, world.uavs[i]);
    const AircraftShape& shape = geometry.ShapeOf(i);
    const Mesh body =
        BodyFor(shape, X_LB[i].Middle().translation().norm(), scenario.rig.calibrated.FocalPx());
    const auto label = static_cast<std::uint8_t>(i + 1);
    DrawInto(shape, body, X_LB[i], label, width_px, height_px, {cameras.left, &labels.left});
    DrawInto(shape, body, X_RB[i], label, width_px, height_px, {cameras.right, &labels.right});
  }
  for (std::size_t at = 0; at < n; ++at) {
    if (labels.left.mask[at] == 0) continue;
    const std::size_t i = labels.left.mask[at] - 1u;
    labels.disparity_px[at] = DisparityAt(
        static_cast<int>(at) % width_px, static_cast<int>(at) / width_px, labels.left.depth_m[at],
        cameras.left.camera, X_LB[i], cameras.right.camera, X_RB[i]);
  }
  return labels;
}

void WriteDenseLabels(const DenseLabels& labels, const std::filesystem::path& folder) {
  const auto floats = [&](const std::vector<float>& values) {
    return cv::Mat(labels.height_px, labels.width_px, CV_32FC1, const_cast<float*>(values.data()));
  };
  const auto bytes = [&](const std::vector<std::uint8_t>& values) {
    return cv::Mat(labels.height_px, labels.width_px, CV_8UC1,
                   const_cast<std::uint8_t*>(values.data()));
  };
  std::filesystem::create_directories(folder);
  WriteImageFile(floats(labels.left.depth_m), folder / "depth_left.tiff");
  WriteImageFile(floats(labels.right.depth_m), folder / "depth_right.tiff");
  WriteImageFile(floats(labels.disparity_px), folder / "disparity.tiff");
  WriteImageFile(bytes(labels.left.mask), folder / "mask_left.png");
  WriteImageFile(bytes(labels.right.mask), folder / "mask_right.png");
}

}  // namespace windhover
