#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "camera/stereo_rig.h"
#include "rig/flex.h"
#include "rig/misalignment.h"
#include "rig/vibration.h"

namespace windhover {

/// The true stereo rig of one aircraft as a pure function of time: misaligned, shaking, bending.
///
/// Any t, in any order, from any thread, with the same result: exposure integrals, rolling
/// shutters and threads need no shared state.
class RigMotion {
 public:
  /// `name` makes the random streams of this aircraft its own ("uav0").
  /// @throws ConfigError if a recording or PSD file cannot be used.
  RigMotion(const StereoRig& calibrated, const Misalignment& misalignment, const FlexConfig& flex,
            const VibrationConfig& vibration, std::uint64_t seed, const std::string& name);
  ~RigMotion();
  RigMotion(RigMotion&&) noexcept;

  /// Both cameras in the rig frame R at time `t_s`.
  PosedStereoRig At(double t_s) const;

  /// How far any pixel can move between `t0_s` and `t1_s` by vibration and flex alone, px.
  double MotionBoundPx(double t0_s, double t1_s) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace windhover
