#pragma once

#include <complex>

#include <Eigen/Core>

#include "rig/flex.h"

namespace windhover {

/// Tip deflection (m) per acceleration of the bar's root (m/s²) in the first bending mode:
/// q̈ + 2 ζ ω₁ q̇ + ω₁² q = -Γ a. The tip is taken to move with the root where flex is disabled.
/// Source: S. S. Rao, "Mechanical Vibrations", cantilever with a tip mass.
std::complex<double> BendingResponse(const FlexConfig& flex, double frequency_hz);

/// Slope of the bar at its tip, rad, for a deflection `tip_m` of a half bar of length
/// `half_span_m`: 1.5 q / L, the shape of a cantilever loaded at its tip.
inline double TipSlope_rad(double tip_m, double half_span_m) { return 1.5 * tip_m / half_span_m; }

/// How one tip moves when both bend by `forward_m` and `up_m`, in the axes of the rig frame R.
/// `side`: -1 for the left tip, +1 for the right.
struct TipMotion {
  Eigen::Vector3d shift_m;
  Eigen::Vector3d turn_rad;  ///< Rotation vector.
};
TipMotion BentTip(double forward_m, double up_m, double half_span_m, int side);

}  // namespace windhover
