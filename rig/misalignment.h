#pragma once

#include "camera/stereo_rig.h"
#include "common/config/fields.h"

namespace windhover {

/// How the true rig differs from the calibrated one, at rest. "Relative" is right minus left,
/// half to each camera; signs follow the camera frame C (yaw about y, pitch about x, roll
/// about z), so that a positive relative yaw makes the optical axes diverge.
struct Misalignment {
  double yaw_deg = 0, pitch_deg = 0, roll_deg = 0;
  double offset_px = 0;

  /// Of one camera alone, added to its half of the relative values.
  struct OneCamera {
    double yaw_deg = 0, pitch_deg = 0, roll_deg = 0, cx_px = 0, cy_px = 0;

    template <typename Visitor>
    void Fields(Visitor& v) {
      v.Field("yaw_deg", yaw_deg, InRange{-30, 30}, "turn about the camera's y axis");
      v.Field("pitch_deg", pitch_deg, InRange{-30, 30}, "turn about the camera's x axis");
      v.Field("roll_deg", roll_deg, InRange{-30, 30}, "turn about the camera's z axis");
      v.Field("cx_px", cx_px, InRange{-1000, 1000}, "shift of the principal point to the right");
      v.Field("cy_px", cy_px, InRange{-1000, 1000}, "downward shift of the principal point");
    }
  };
  OneCamera left, right;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("yaw_deg", yaw_deg, InRange{-30, 30}, "relative yaw, right minus left; > 0 diverges");
    v.Field("pitch_deg", pitch_deg, InRange{-30, 30}, "relative pitch, right minus left");
    v.Field("roll_deg", roll_deg, InRange{-30, 30}, "relative roll, right minus left");
    v.Field("offset_px", offset_px, InRange{-1000, 1000},
            "principal points: cx of the left camera minus cx of the right");
    v.Section("left", left, "of the left camera alone");
    v.Section("right", right, "of the right camera alone");
  }
};

/// The true rig at rest. The three angles of a camera are the components of one rotation vector
/// in its own axes, about its optical centre.
PosedStereoRig Misaligned(const StereoRig& rig, const Misalignment& misalignment);

}  // namespace windhover
