#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "scenarios/scenario.h"
#include "sim/kinematics.h"

namespace windhover {

/// Speeds and phases of an aircraft's four rotors. At hover they differ by up to 3 % (mixing and
/// an off-centre load); thrust goes with the square of their speed.
class Rotors {
 public:
  /// `name` ("uav0") makes the differences this aircraft's own.
  Rotors(AircraftType type, std::uint64_t seed, const std::string& name);

  /// Turns them for `duration_s`, in the end as fast as `state` needs.
  void Advance(double duration_s, const Kinematics& state);

  const std::array<double, 4>& phase_rev() const { return phase_rev_; }
  const std::array<double, 4>& rate_hz() const { return rate_hz_; }

 private:
  std::array<double, 4> hover_hz_, rate_hz_, phase_rev_{};
};

}  // namespace windhover
