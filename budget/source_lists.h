#pragma once

#include <array>
#include <vector>

#include "budget/error_budget.h"

namespace windhover {

using ErrorSources = std::vector<ErrorSource>;

// Each appends what `scenario` switches on.

/// Focus and warmth of the lenses.
void AddLensSources(const Scenario& scenario, ErrorSources* sources);
/// When the cameras expose.
void AddShutterSources(const Scenario& scenario, ErrorSources* sources);
/// Vibration, warmth, drift and landings.
void AddBarSources(const Scenario& scenario, ErrorSources* sources);
/// Noise and gross errors of geometric boxes.
void AddBoxSources(const Scenario& scenario, ErrorSources* sources);
/// UWB, where the score is held against it.
void AddLabelSources(const Scenario& scenario, ErrorSources* sources);

/// Of the target, from the rig: unit vector in R.
Eigen::Vector3d DirectionOf(const Sight& at);
/// How fast the target's range grows.
double RangeRate_mps(const Sight& at);

/// The error of range by a disparity that errs by a constant and by noise; the mean has its
/// second-order term, all that noise does to it.
Effect OfDisparity(const Sight& at, double mean_px, double sigma_px);

/// The error of range by a constant amount of a disturbance.
Effect OfAmount(Disturbance disturbance, const Sight& at, double amount);

/// Mean and standard deviation of relative pitch, yaw and roll, in this order, deg.
struct RelativeAngles {
  std::array<double, 3> mean_deg{}, sigma_deg{};
};

/// Of these angles, and of independent noise of disparity.
Effect OfAngles(const RelativeAngles& angles, const Sight& at, double noise_px = 0);

}  // namespace windhover
