#pragma once

#include <span>

#include <Eigen/Core>

#include "swarm/flocking.h"

namespace windhover {

/// The sigma-norm of R. Olfati-Saber, "Flocking for multi-agent dynamic systems", IEEE TAC 51(3),
/// 2006, eq. 8: (√(1 + ε z²) − 1) / ε, smooth also at 0.
double SigmaNorm(double z_m, double epsilon);

/// Acceleration along the line to a neighbour over the gradient of the sigma-norm, eq. 15: negative
/// nearer than distance_m, positive farther, 0 from reach · distance_m on. `z`: sigma-norm.
double OlfatiSaberAction(const OlfatiSaberConfig& config, double z);

/// Acceleration by Olfati-Saber's Algorithm 2, in free space: c1 Σ φ(‖r‖σ) ∇‖r‖σ
/// + c2 Σ ρ_h(‖r‖σ / ‖r_max‖σ) (v_j − v), and a navigational term c_γ (preferred − v), whose
/// preferred velocity stands for the paper's γ-agent.
Eigen::Vector3d OlfatiSaberAcceleration(const OlfatiSaberConfig& config,
                                        std::span<const Neighbour> neighbours,
                                        const Eigen::Vector3d& v_mps,
                                        const Eigen::Vector3d& preferred_mps);

/// Acceleration in O. Khatib's artificial potential field (IJRR 5(1), 1986):
/// η (1/ρ − 1/ρ0) / ρ² away from each neighbour with a clearance ρ below ρ0, the gradient of
/// η/2 (1/ρ − 1/ρ0)², and damping towards the preferred velocity, which has the goal in it.
Eigen::Vector3d PotentialFieldAcceleration(const PotentialFieldConfig& config,
                                           std::span<const Neighbour> neighbours,
                                           const Eigen::Vector3d& v_mps,
                                           const Eigen::Vector3d& preferred_mps);

}  // namespace windhover
