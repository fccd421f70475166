#pragma once

#include <span>

#include <Eigen/Core>

#include "scenarios/swarm_config.h"

namespace windhover {

/// Another aircraft as one knows it: where it is from oneself, and how it moves; axes of W.
struct Neighbour {
  Eigen::Vector3d p_m;
  Eigen::Vector3d v_mps;
  double sigma_m = 0;   ///< One standard deviation of |p_m|.
  double unseen_s = 0;  ///< Since the last sighting.
};

/// Velocity by C. Reynolds' rules as F. Schilling et al. weigh them (RA-L 2021, eq. 1 to 5):
/// -k_s mean(r / |r|²) + k_c mean(r) + k_a mean(v) + k_m migration, r from oneself to a neighbour.
/// Two at rest settle at √(k_s / k_c).
Eigen::Vector3d ReynoldsVelocity(const ReynoldsConfig& config,
                                 std::span<const Neighbour> neighbours,
                                 const Eigen::Vector3d& migration_mps);

/// Velocity by G. Vásárhelyi et al. (Science Robotics 2018, eq. 1 to 5) in free space: migration,
/// repulsion below repulsion_m, and friction against relative velocities beyond what the braking
/// curve allows. `v_mps`: one's own.
Eigen::Vector3d VasarhelyiVelocity(const VasarhelyiConfig& config,
                                   std::span<const Neighbour> neighbours,
                                   const Eigen::Vector3d& v_mps,
                                   const Eigen::Vector3d& migration_mps);

/// Speed at which a distance of `error_m` may be closed: gain · error, but no more than can be
/// lost again at `deceleration_mps2`. Has the sign of the error. Source: the braking curve D of
/// Vásárhelyi et al., eq. 3.
double BrakingSpeed(double error_m, double gain_per_s, double deceleration_mps2);

/// The distance in which BrakingSpeed goes from `speed_mps` to 0, its inverse: v / p below the
/// knee of a / p, (v² / a + a / p²) / 2 above. Has the sign of the speed.
double StoppingDistance(double speed_mps, double gain_per_s, double deceleration_mps2);

}  // namespace windhover
