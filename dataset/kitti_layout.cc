#include "dataset/kitti_layout.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "common/config/enum_name.h"
#include "common/file/whole_file.h"
#include "dataset/box_text.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

std::string NumberOf(const PairId& id) { return fmt::format("{:06}", id.number); }

// 0 fully visible, 1 partly hidden, 2 mostly hidden, as KITTI's levels.
int OcclusionLevel(double hidden_share) {
  return hidden_share < 0.1 ? 0 : hidden_share < 0.5 ? 1 : 2;
}

Eigen::Matrix3d RotationOf(const uav_truth_t& uav) {
  return Eigen::Quaterniond(uav.qw, uav.qx, uav.qy, uav.qz).toRotationMatrix();
}

double Wrapped(double angle_rad) { return std::remainder(angle_rad, 2 * std::numbers::pi); }

// Height, width and length of the box around body and propellers in the target's own axes, m.
Eigen::Vector3d SizeOf(const AircraftShape& shape) {
  Eigen::AlignedBox3f box;
  for (const auto* mesh : {&shape.model.body, &shape.model.rotor_discs}) {
    for (const Eigen::Vector3f& p : mesh->positions) box.extend(p);
  }
  const Eigen::Vector3d forward_left_up = box.sizes().cast<double>();
  return {forward_left_up.z(), forward_left_up.y(), forward_left_up.x()};
}

std::string LineOf(const LabelledPair& pair, std::size_t i) {
  const target_annotation_t& target = pair.Target(i);
  const ObserverRig& rig = pair.geometry.Observers().front();
  const uav_truth_t& own = pair.pair.world.uavs[rig.position];
  const uav_truth_t& other = pair.pair.world.uavs[pair.PositionOf(i)];
  const Eigen::Vector3d size_m = SizeOf(pair.geometry.ShapeOf(pair.PositionOf(i)));
  const double half_baseline_m = pair.flight.scenario.rig.calibrated.baseline_m / 2;
  const Eigen::Vector3d centre_C_m =
      Eigen::Vector3d(target.p_RT_m) + half_baseline_m * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d forward_C =
      (RotationOf(own) * rig.X_BR.linear()).transpose() * RotationOf(other).col(0);
  const double yaw_rad = std::atan2(-forward_C.z(), forward_C.x());
  const double alpha_rad = Wrapped(yaw_rad - std::atan2(centre_C_m.x(), centre_C_m.z()));
  const BoxEdges box = EdgesOf(target.left.visible);
  // KITTI counts pixels from the middle of the first one, and names the box's last pixel.
  return fmt::format(
      "UAV {:.2f} {} {:.6f} {:.2f} {:.2f} {:.2f} {:.2f} {:.4f} {:.4f} {:.4f} {:.4f} {:.4f} {:.4f} "
      "{:.6f}\n",
      std::max(target.left.truncation, 0.0), OcclusionLevel(target.left.occlusion), alpha_rad,
      box.left_px, box.top_px, box.right_px - 1, box.bottom_px - 1, size_m[0], size_m[1], size_m[2],
      centre_C_m.x(), centre_C_m.y() + size_m[0] / 2, centre_C_m.z(), yaw_rad);
}

std::string Projection(const Intrinsics& k, double shift_px_m) {
  return fmt::format("{:.12e} 0 {:.12e} {:.12e} 0 {:.12e} {:.12e} 0 0 0 1 0", k.fx_px, k.cx_px,
                     shift_px_m, k.fy_px, k.cy_px);
}

std::string CalibrationOf(const LabelledPair& pair) {
  const StereoRig rig = pair.flight.scenario.rig.calibrated.ToStereoRig();
  const Intrinsics left = rig.left.intrinsics(), right = rig.right.intrinsics();
  const std::string p2 = Projection(left, 0), p3 = Projection(right, -right.fx_px * rig.baseline_m);
  return fmt::format(
      "P0: {0}\nP1: {1}\nP2: {0}\nP3: {1}\nR0_rect: 1 0 0 0 1 0 0 0 1\n"
      "Tr_velo_to_cam: 1 0 0 0 0 1 0 0 0 0 1 0\nTr_imu_to_velo: 1 0 0 0 0 1 0 0 0 0 1 0\n",
      p2, p3);
}

}  // namespace

StereoFiles KittiLayout::ImageFiles(const PairId& id) const {
  const fs::path folder = "training";
  const std::string name = NumberOf(id) + ".png";
  return {folder / "image_2" / name, folder / "image_3" / name};
}

void KittiLayout::Add(const LabelledPair& pair) {
  const fs::path folder = folder_ / "training";
  std::string labels;
  for (std::size_t i = 0; i < pair.annotation.targets.size(); ++i) {
    if (pair.Target(i).left.visible.w_px > 0) labels += LineOf(pair, i);
  }
  const std::string name = NumberOf(pair.id) + ".txt";
  ReplaceFile(WithFolders(folder / "label_2" / name), labels);
  ReplaceFile(WithFolders(folder / "calib" / name), CalibrationOf(pair));
  image_sets_[pair.id.split] += NumberOf(pair.id) + '\n';
}

void KittiLayout::Finish() {
  for (const auto& [split, numbers] : image_sets_) {
    ReplaceFile(WithFolders(folder_ / "ImageSets" / (NameOf(split) + ".txt")), numbers);
  }
}

}  // namespace windhover
