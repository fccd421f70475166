#pragma once

#include "rig/driven_bar.h"
#include "scenarios/scenario.h"
#include "sim/kinematics.h"
#include "sim/rotors.h"

namespace windhover {

/// The bar of the rig that an aircraft carries, as its rotors and manoeuvres make it ring.
class CarriedBar {
 public:
  /// At time 0, as if it had always flown like this.
  CarriedBar(const Scenario& scenario, int aircraft_id, const Kinematics& state,
             const RotorsTurning& rotors);

  /// Takes it on to the time `t_s`, at which the aircraft is in `state`.
  void AdvanceTo(double t_s, const Kinematics& state, const RotorsTurning& rotors);

  const BarState& State() const { return *drive_.bar; }

 private:
  DrivenBar bar_;
  RigDrive drive_;
};

}  // namespace windhover
