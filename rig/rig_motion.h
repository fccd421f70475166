#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "camera/stereo_rig.h"
#include "rig/flex.h"
#include "rig/misalignment.h"
#include "rig/rig_lines.h"
#include "rig/vibration.h"

namespace windhover {

/// The true stereo rig of one aircraft as a pure function of time: misaligned, shaking, bending.
///
/// Vibration at the root of the bar turns the whole rig (the integral of its angular rate) and
/// bends both halves of the bar (its acceleration through BendingResponse): fore-aft bending turns
/// the cameras against each other in yaw, vertical bending in roll. Lateral acceleration stretches
/// the bar, which is stiff. The root's axes are those of a rig that looks along the body's x axis.
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

  /// How the rig at time `t_s` differs from the rig at rest.
  RigDeflection DeflectionAt(double t_s) const;

  /// How far the image of any point beyond 1 m can move between two moments of [t0_s, t1_s] by
  /// vibration and flex alone, px. An upper bound; 0 without vibration.
  double MotionBoundPx(double t0_s, double t1_s) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace windhover
