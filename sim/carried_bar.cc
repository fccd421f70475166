#include "sim/carried_bar.h"

#include <fmt/format.h>

namespace windhover {
namespace {

RigDrive DriveAt(double t_s, const Kinematics& state, const RotorsTurning& rotors) {
  return {.start_s = t_s,
          .rotor_phase_rev = rotors.phase_rev,
          .rotor_rate_hz = rotors.rate_hz,
          .specific_force_B_mps2 = state.q_WB.inverse() * (state.a_WB_mps2 - GravityInWorld()),
          .bar = std::nullopt};
}

}  // namespace

CarriedBar::CarriedBar(const Scenario& scenario, int aircraft_id, const Kinematics& state,
                       const RotorsTurning& rotors)
    : bar_(scenario.flex, scenario.vibration, scenario.rig.calibrated.baseline_m,
           scenario.random_seed, fmt::format("uav{}", aircraft_id)),
      drive_(DriveAt(0, state, rotors)) {
  drive_.bar = bar_.Stepped(drive_, drive_);
}

void CarriedBar::AdvanceTo(double t_s, const Kinematics& state, const RotorsTurning& rotors) {
  RigDrive now = DriveAt(t_s, state, rotors);
  now.bar = bar_.Stepped(drive_, now);
  drive_ = now;
}

}  // namespace windhover
