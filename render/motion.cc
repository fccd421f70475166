#include "render/motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/geometry/rotation.h"
#include "common/time/sim_time.h"
#include "rig/power_spectrum.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

// How far a camera that turns by `R` moves its image: yaw and pitch everywhere alike, roll at
// the corners of a 22 degree view, 0.2 rad off the axis.
double ImageMotionRad(const Eigen::Matrix3d& R) {
  constexpr double kCorner_rad = 0.2;
  const Eigen::AngleAxisd turn(R);
  const Vector3d w_rad = turn.angle() * turn.axis();
  return w_rad.head<2>().norm() + kCorner_rad * std::abs(w_rad.z());
}

// Longest way that the image of either camera goes between neighbouring moments, summed: px.
double RigMotionPx(const RigMotion& rig, const RigDrive& drive, double duration_s,
                   double focal_px) {
  constexpr int kSteps = 8;
  std::vector<double> times_s;
  for (int i = 0; i <= kSteps; ++i) {
    times_s.push_back(drive.start_s + duration_s * (static_cast<double>(i) / kSteps - 0.5));
  }
  const std::vector<PosedStereoRig> rigs = rig.AtMany(times_s, drive);
  double left_rad = 0, right_rad = 0;
  for (std::size_t i = 1; i < rigs.size(); ++i) {
    const PosedStereoRig &before = rigs[i - 1], &now = rigs[i];
    left_rad += ImageMotionRad(before.left.X_RC.linear().transpose() * now.left.X_RC.linear());
    right_rad += ImageMotionRad(before.right.X_RC.linear().transpose() * now.right.X_RC.linear());
  }
  return std::max(left_rad, right_rad) * focal_px;
}

double TargetSpeedRadps(const uav_truth_t& observer, const uav_truth_t& target) {
  const Vector3d offset_m = Vector3d(target.p_WB_m) - Vector3d(observer.p_WB_m);
  const Vector3d v_mps = Vector3d(target.v_WB_mps) - Vector3d(observer.v_WB_mps);
  constexpr double kRadius_m = 0.5;  // Of an aircraft, for its own turning.
  return (v_mps.norm() + Vector3d(target.w_WB_B_radps).norm() * kRadius_m) /
         std::max(offset_m.norm(), 1.0);
}

}  // namespace

Eigen::Isometry3d PoseAt(const uav_truth_t& truth, double dt_s) {
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
  X_WB.translation() = Vector3d(truth.p_WB_m);
  X_WB.linear() =
      Eigen::Quaterniond(truth.qw, truth.qx, truth.qy, truth.qz).normalized().toRotationMatrix();
  if (dt_s == 0) return X_WB;
  X_WB.translation() += dt_s * Vector3d(truth.v_WB_mps);
  X_WB.linear() = X_WB.linear() * RotationFromVector(dt_s * Vector3d(truth.w_WB_B_radps));
  return X_WB;
}

RotorTurning TurningOf(const uav_truth_t& truth, double middle_s, double duration_s) {
  RotorTurning turning;
  turning.duration_s = duration_s;
  for (std::size_t i = 0; i < turning.rate_hz.size(); ++i) {
    turning.rate_hz[i] = truth.rotor_rate_hz[i];
    turning.phase_rev[i] = truth.rotor_phase_rev[i] + middle_s * truth.rotor_rate_hz[i];
  }
  return turning;
}

RigDrive DriveOf(const world_truth_t& world, std::size_t observer) {
  const uav_truth_t& truth = world.uavs[observer];
  RigDrive drive;
  drive.start_s = SecondsFromUtime(world.utime);
  std::copy_n(truth.rotor_phase_rev, 4, drive.rotor_phase_rev.begin());
  std::copy_n(truth.rotor_rate_hz, 4, drive.rotor_rate_hz.begin());
  const Vector3d specific_force_W =
      Vector3d(truth.a_WB_mps2) + kStandardGravity_mps2 * Vector3d::UnitZ();
  drive.specific_force_B_mps2 = PoseAt(truth, 0).linear().transpose() * specific_force_W;
  std::array<double, 12> bar;
  if (truth.modal_state.size() == bar.size()) {
    std::copy_n(truth.modal_state.begin(), bar.size(), bar.begin());
    drive.bar = BarStateFrom(bar);
  }
  return drive;
}

std::vector<ExposureNode> BackgroundNodes(double motion_px, double duration_s, int max_nodes) {
  struct Rule {
    double longest_motion_px;
    std::vector<ExposureNode> nodes;  // Of an exposure of 1 s.
  };
  static const std::array<Rule, 5> kRules = {
      {{1, {{0, 65536}}},
       {2.5, {{-0.28867513459481288, 32768}, {0.28867513459481288, 32768}}},
       {5, {{-0.38729833462074169, 18204}, {0, 29128}, {0.38729833462074169, 18204}}},
       {7.5,
        {{-0.43056815579702629, 11398},
         {-0.16999052179242813, 21370},
         {0.16999052179242813, 21370},
         {0.43056815579702629, 11398}}},
       {1e9,
        {{-0.45308992296933200, 7764},
         {-0.26923465505284155, 15684},
         {0, 18640},
         {0.26923465505284155, 15684},
         {0.45308992296933200, 7764}}}}};
  std::size_t rule = 0;
  while (rule + 1 < kRules.size() && rule + 1 < static_cast<std::size_t>(max_nodes) &&
         motion_px > kRules[rule].longest_motion_px) {
    ++rule;
  }
  std::vector<ExposureNode> nodes = kRules[rule].nodes;
  for (ExposureNode& node : nodes) node.offset_s *= duration_s;
  return nodes;
}

ExposurePlan PlanExposure(const ExposureConfig& config, double duration_s,
                          const world_truth_t& world, std::size_t observer, const RigMotion& rig,
                          double focal_px) {
  const uav_truth_t& self = world.uavs[observer];
  double fastest_radps = 0;
  for (std::size_t i = 0; i < world.uavs.size(); ++i) {
    if (i == observer) continue;
    fastest_radps = std::max(fastest_radps, TargetSpeedRadps(self, world.uavs[i]));
  }
  // Far surroundings only turn with the cameras; targets go across the image besides.
  const double turning_px = RigMotionPx(rig, DriveOf(world, observer), duration_s, focal_px) +
                            Vector3d(self.w_WB_B_radps).norm() * duration_s * focal_px;
  const double motion_px = turning_px + fastest_radps * duration_s * focal_px;
  int count = static_cast<int>(
      std::clamp(std::ceil(motion_px / config.max_blur_px), 1.0, 1.0 * config.max_samples));
  if (count % 2 == 0) count += count < config.max_samples ? 1 : -1;
  ExposurePlan plan;
  for (int i = 0; i < count; ++i) {
    plan.offsets_s.push_back(duration_s * ((i + 0.5) / count - 0.5));
  }
  plan.offsets_s[static_cast<std::size_t>(count / 2)] = 0;
  plan.background = BackgroundNodes(turning_px, duration_s, config.max_samples);
  return plan;
}

StereoRowCameras CamerasByRows(const world_truth_t& world, std::size_t observer,
                               const Eigen::Isometry3d& X_BR, const RigMotion& rig,
                               const StereoShutterTimes& shutter, int height_px, double offset_s) {
  const auto row_times_s = [&](const ShutterTimes& times) {
    if (times.row_time_s == 0) return std::vector<double>{times.middle_s + offset_s};
    std::vector<double> times_s;
    for (int i = 0; i <= (height_px + kRowStep_px - 1) / kRowStep_px; ++i) {
      times_s.push_back(times.RowMiddle_s(i * kRowStep_px) + offset_s);
    }
    return times_s;
  };
  const auto place = [&](std::vector<double> times_s, const std::vector<PosedStereoRig>& rigs,
                         PosedCamera PosedStereoRig::*side) {
    RowCameras cameras{(rigs.front().*side).camera, std::move(times_s), {}};
    for (std::size_t i = 0; i < rigs.size(); ++i) {
      const Eigen::Isometry3d X_WR = PoseAt(world.uavs[observer], cameras.times_s[i]) * X_BR;
      cameras.X_WC.push_back(X_WR * (rigs[i].*side).X_RC);
    }
    return cameras;
  };
  const RigDrive drive = DriveOf(world, observer);
  const auto rigs_at = [&](std::vector<double> times_s) {
    for (double& time_s : times_s) time_s += SecondsFromUtime(world.utime);
    if (times_s.size() == 1) return std::vector{rig.AtAlone(times_s[0], drive)};
    return rig.AtMany(times_s, drive);
  };
  const std::vector<double> left_s = row_times_s(shutter.left);
  const std::vector<double> right_s = row_times_s(shutter.right);
  const std::vector<PosedStereoRig> at_left = rigs_at(left_s);
  return {place(left_s, at_left, &PosedStereoRig::left),
          place(right_s, right_s == left_s ? at_left : rigs_at(right_s), &PosedStereoRig::right)};
}

RowPoses PosesOf(const RowCameras& cameras, const uav_truth_t& target) {
  RowPoses poses;
  poses.row_step_px = kRowStep_px;
  for (std::size_t i = 0; i < cameras.X_WC.size(); ++i) {
    poses.X_CB.push_back(cameras.X_WC[i].inverse() * PoseAt(target, cameras.times_s[i]));
  }
  return poses;
}

}  // namespace windhover
