#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "scenarios/scenario.h"
#include "sim/kinematics.h"

namespace windhover {

/// How four rotors turn: revolutions since the start of the run, and their rates.
struct RotorsTurning {
  std::array<double, 4> phase_rev{}, rate_hz{};
};

/// The four rotors of a kinematic aircraft. At hover their speeds differ by up to 3 % (mixing and
/// an off-centre load); thrust goes with the square of their speed.
class Rotors {
 public:
  /// `name` ("uav0") makes the differences this aircraft's own.
  Rotors(AircraftType type, std::uint64_t seed, const std::string& name);

  /// Turns them for `duration_s`, in the end as fast as `state` needs.
  void Advance(double duration_s, const Kinematics& state);

  const RotorsTurning& Turning() const { return turning_; }

 private:
  std::array<double, 4> hover_hz_;
  RotorsTurning turning_;
};

}  // namespace windhover
