#include "scenarios/aircraft_config.h"

#include "common/geometry/rotation.h"

namespace windhover {

StereoRig CalibratedRig::ToStereoRig() const {
  const double focal_px = FocalPx();
  const AnyCamera camera =
      MakeCamera({focal_px, focal_px, (image[0] - 1) / 2.0, (image[1] - 1) / 2.0}, distortion);
  return {.left = camera,
          .right = camera,
          .baseline_m = baseline_m,
          .width_px = image[0],
          .height_px = image[1]};
}

Eigen::Isometry3d CalibratedRig::X_BR() const {
  Eigen::Isometry3d X_BR = Eigen::Isometry3d::Identity();
  X_BR.translation() = Eigen::Vector3d(mount.position_m.data());
  // A positive turn about the camera's x axis (right) raises its optical axis.
  X_BR.linear() =
      R_BC_Forward() * RotationFromVector(Eigen::Vector3d(RadFromDeg(mount.pitch_deg), 0, 0));
  return X_BR;
}

}  // namespace windhover
