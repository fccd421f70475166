#pragma once

#include <array>

#include <Eigen/Core>

namespace windhover {

/// Where a propeller of two blades turns about B's z axis.
struct Propeller {
  Eigen::Vector3f hub_m;
  float radius_m;
  /// Whose rate and phase it has, as UAV_TRUTH counts: 0 front left, 1 front right, 2 rear right,
  /// 3 rear left. At phase 0 its blades lie along B's x axis.
  int rotor;

  /// Height of the slice of air that pitched blades sweep, m.
  static constexpr float kHeight_m = 0.012f;

  /// From leading to trailing edge, seen along the axis: 0.17 radii at the root, 0.09 at the tip,
  /// in a straight line (docs/physics.md).
  double Chord_m(double r_m) const { return 0.17 * radius_m - 0.08 * r_m; }
};

/// The rotor of the arm that points to (sign_x, sign_y) in B.
int RotorAt(float sign_x, float sign_y);

/// How the rotors of an aircraft turn during an exposure.
struct RotorTurning {
  std::array<double, 4> phase_rev{};  ///< In the middle of the exposure.
  std::array<double, 4> rate_hz{};
  double duration_s = 0;

  /// During `count` of `n_parts` equal parts, from part `first` on.
  RotorTurning Part(std::size_t first, std::size_t count, std::size_t n_parts) const;
};

/// The share of a time in which something `width_rad` wide, found twice a turn, covers a place
/// that it passes: the mean over places within `spread_rad` of one that is `angle_rad` ahead of
/// it in the middle of the time, in which it turns by `turn_rad`. In closed form.
double SweptShare(double angle_rad, double width_rad, double turn_rad, double spread_rad);

/// How opaque a turning propeller is, 0 to 1: the share of the exposure in which a blade hides the
/// line of sight along `direction_B` (unit) that enters its slice of air at `p_B_m`. Blades are
/// flat sheets across the slice, their leading edges up. `spread_rad`: of the places about the hub
/// for which it stands.
double BladeCoverage(const Propeller& propeller, const RotorTurning& turning,
                     const Eigen::Vector3d& p_B_m, const Eigen::Vector3d& direction_B,
                     double spread_rad);

}  // namespace windhover
