#pragma once

#include "scenarios/scenario.h"

namespace windhover {

/// Root mean square of the angles by which a bending bar turns its cameras against each other.
struct BarAngles {
  double yaw_rad = 0, roll_rad = 0;
};

/// Of stationary vibration, in closed form: the power of the vibration's lines through the first
/// bending mode, 3 / L of slope per deflection of both tips.
/// @throws ConfigError if a vibration file cannot be used.
BarAngles BarAnglesByVibration(const Scenario& scenario);

}  // namespace windhover
