#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "camera/stereo_rig.h"
#include "rig/driven_bar.h"
#include "rig/flex.h"
#include "rig/misalignment.h"
#include "rig/vibration.h"

namespace windhover {

/// How the rig differs from the rig at rest.
struct RigDeflection {
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();  ///< Of the whole rig: a vector in R.
  TipDeflection left, right;
  /// Of the cameras against each other, right minus left, half to each: drift and landing.
  Eigen::Vector3d relative_turn_rad = Eigen::Vector3d::Zero();
};

/// The true stereo rig of one aircraft as a pure function of time: misaligned, warped, shaking,
/// bending.
///
/// Vibration at the root of the bar turns the whole rig (the integral of its angular rate) and
/// drives the modes of both halves of the bar (BarModes): fore-aft bending turns the cameras
/// against each other in yaw, vertical bending in roll. The root shifts too little to see. Lateral
/// acceleration stretches the bar, which is stiff. The root's axes are those of a rig that looks
/// along the body's x axis.
///
/// Any t, in any order, from any thread, with the same result: exposure integrals, rolling
/// shutters and threads need no shared state. One time at a time or many at once, the bits are the
/// same; AtAlone() rounds otherwise.
class RigMotion {
 public:
  /// `name` makes the random streams of this aircraft its own ("uav0"). Where `mean_over_s` is not
  /// 0, all of vibration and bending is the mean over so long about the time asked for, in closed
  /// form: what an exposure sees.
  /// @throws ConfigError if a recording or PSD file cannot be used.
  RigMotion(const StereoRig& calibrated, const Misalignment& misalignment, const FlexConfig& flex,
            const VibrationConfig& vibration, std::uint64_t seed, const std::string& name,
            double mean_over_s = 0);
  ~RigMotion();
  RigMotion(RigMotion&&) noexcept;

  /// Both cameras in the rig frame R at time `t_s`, near or after the start of `drive`.
  PosedStereoRig At(double t_s, const RigDrive& drive = {}) const;

  /// The same at many times, which cost less each.
  std::vector<PosedStereoRig> AtMany(const std::vector<double>& times_s,
                                     const RigDrive& drive = {}) const;

  /// At(), for a time without neighbours: cheaper, and different by roundings (1e-13 of the
  /// vibration).
  PosedStereoRig AtAlone(double t_s, const RigDrive& drive = {}) const;

  RigDeflection DeflectionAt(double t_s, const RigDrive& drive = {}) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace windhover
