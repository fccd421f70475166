#pragma once

#include <cstdint>
#include <string>

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

  /// What differs from flight to flight, added to the relative values (Drawn): cameras are
  /// mounted anew. Normal distributions, and one uniform.
  struct Random {
    double yaw_sigma_deg = 0, pitch_sigma_deg = 0, roll_sigma_deg = 0;
    double offset_sigma_px = 0, offset_spread_px = 0;

    template <typename Visitor>
    void Fields(Visitor& v) {
      v.Field("yaw_sigma_deg", yaw_sigma_deg, InRange{0, 10}, "standard deviation of yaw_deg");
      v.Field("pitch_sigma_deg", pitch_sigma_deg, InRange{0, 10}, "the same of pitch_deg");
      v.Field("roll_sigma_deg", roll_sigma_deg, InRange{0, 10}, "the same of roll_deg");
      v.Field("offset_sigma_px", offset_sigma_px, InRange{0, 1000}, "the same of offset_px");
      v.Field("offset_spread_px", offset_spread_px, InRange{0, 1000},
              "offset_px is uniform up to this far to either side");
    }
  };
  Random random;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("yaw_deg", yaw_deg, InRange{-30, 30}, "relative yaw, right minus left; > 0 diverges");
    v.Field("pitch_deg", pitch_deg, InRange{-30, 30}, "relative pitch, right minus left");
    v.Field("roll_deg", roll_deg, InRange{-30, 30}, "relative roll, right minus left");
    v.Field("offset_px", offset_px, InRange{-1000, 1000},
            "principal points: cx of the left camera minus cx of the right");
    v.Section("left", left, "of the left camera alone");
    v.Section("right", right, "of the right camera alone");
    v.Section("random", random, "drawn anew for every random_seed and aircraft");
  }
};

/// The misalignment of one flight: `random` drawn and added to the relative values, then cleared.
/// `name` ("uav0") makes the draw this aircraft's own.
Misalignment Drawn(Misalignment misalignment, std::uint64_t seed, const std::string& name);

/// The true rig at rest, `random` left aside. The three angles of a camera are the components of
/// one rotation vector in its own axes, about its optical centre.
PosedStereoRig Misaligned(const StereoRig& rig, const Misalignment& misalignment);

}  // namespace windhover
