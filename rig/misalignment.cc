#include "rig/misalignment.h"

#include "common/geometry/rotation.h"
#include "common/random/random_stream.h"

namespace windhover {
namespace {

// `share`: this camera's part of the relative values, -1/2 for the left and +1/2 for the right.
PosedCamera Misaligned(PosedCamera posed, const Misalignment& relative,
                       const Misalignment::OneCamera& own, double share) {
  Intrinsics intrinsics = posed.camera.intrinsics();
  intrinsics.cx_px += own.cx_px - share * relative.offset_px;
  intrinsics.cy_px += own.cy_px;
  posed.camera = posed.camera.With(intrinsics);
  const Eigen::Vector3d turn_deg(share * relative.pitch_deg + own.pitch_deg,
                                 share * relative.yaw_deg + own.yaw_deg,
                                 share * relative.roll_deg + own.roll_deg);
  posed.X_RC.linear() *= RotationFromVector(turn_deg * RadFromDeg(1));
  return posed;
}

}  // namespace

Misalignment Drawn(Misalignment misalignment, std::uint64_t seed, const std::string& name) {
  RandomStream stream(seed, name + "/misalignment");
  const Misalignment::Random random = misalignment.random;
  misalignment.yaw_deg += random.yaw_sigma_deg * stream.Normal();
  misalignment.pitch_deg += random.pitch_sigma_deg * stream.Normal();
  misalignment.roll_deg += random.roll_sigma_deg * stream.Normal();
  misalignment.offset_px += random.offset_sigma_px * stream.Normal();
  misalignment.offset_px += stream.Uniform(-random.offset_spread_px, random.offset_spread_px);
  misalignment.random = {};
  return misalignment;
}

PosedStereoRig Misaligned(const StereoRig& rig, const Misalignment& misalignment) {
  const PosedStereoRig posed = Posed(rig);
  return {Misaligned(posed.left, misalignment, misalignment.left, -0.5),
          Misaligned(posed.right, misalignment, misalignment.right, 0.5)};
}

}  // namespace windhover
