#include "rig/misalignment.h"

#include "common/geometry/rotation.h"

namespace windhover {
namespace {

// `share`: this camera's part of the relative values, -1/2 for the left and +1/2 for the right.
PosedCamera Misaligned(PosedCamera posed, const Misalignment& relative,
                       const Misalignment::OneCamera& own, double share) {
  posed.camera.cx_px += own.cx_px - share * relative.offset_px;
  posed.camera.cy_px += own.cy_px;
  const Eigen::Vector3d turn_deg(share * relative.pitch_deg + own.pitch_deg,
                                 share * relative.yaw_deg + own.yaw_deg,
                                 share * relative.roll_deg + own.roll_deg);
  posed.X_RC.linear() *= RotationFromVector(turn_deg * RadFromDeg(1));
  return posed;
}

}  // namespace

PosedStereoRig Misaligned(const StereoRig& rig, const Misalignment& misalignment) {
  const PosedStereoRig posed = Posed(rig);
  return {Misaligned(posed.left, misalignment, misalignment.left, -0.5),
          Misaligned(posed.right, misalignment, misalignment.right, 0.5)};
}

}  // namespace windhover
