#pragma once

#include <array>

#include <Eigen/Core>

#include "rig/flex.h"
#include "rig/mode.h"

namespace windhover {

/// How the tip of a half bar is moved from where a rigid bar would have it.
struct TipDeflection {
  double forward_m = 0, up_m = 0;
  double twist_rad = 0;  ///< About the rig's x axis: the camera looks up.
};

/// How that moves the camera, in the axes of the rig frame R.
struct TipMotion {
  Eigen::Vector3d shift_m;
  Eigen::Vector3d turn_rad;  ///< Rotation vector.
};

/// Slope of the bar at its tip, rad, for a deflection `tip_m` of a half bar of length
/// `half_span_m`: 1.5 q / L, the shape of a cantilever loaded at its tip.
inline double TipSlope_rad(double tip_m, double half_span_m) { return 1.5 * tip_m / half_span_m; }

/// `side`: -1 for the left tip, +1 for the right. The shortening of a bent bar, below 1 um for all
/// but the weakest plates, is left out.
TipMotion MotionOf(const TipDeflection& tip, double half_span_m, int side);

/// The modes of a half bar, driven by the motion of its root:
///   q̈ + 2 ζ ω q̇ + ω² q = -Γ a - side Γ' α    forward and up, α about up and backward
///   φ̈ + 2 ζ ω φ̇ + ω² φ = -α                 twist, α about right
/// Both halves are alike; an acceleration moves their tips alike, a turn against each other.
struct BarModes {
  Mode forward, up, twist;
  double participation;            ///< Γ; 0: the bar is rigid.
  double angular_participation_m;  ///< Γ'.
  double twist_participation;      ///< 1; 0: the bar is rigid.
};

/// Of the section and the cameras' mass, unless `flex` gives frequency or participation.
BarModes ModesOf(const FlexConfig& flex, double baseline_m);

/// The modes' coordinates of both tips: left forward, up, twist, right forward, up, twist.
using BarState = std::array<ModeState, 6>;

/// As UAV_TRUTH carries them: q and dq/dt of each coordinate.
std::array<double, 12> ValuesOf(const BarState& state);
BarState BarStateFrom(const std::array<double, 12>& values);

}  // namespace windhover
