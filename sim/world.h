#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/time/sim_time.h"
#include "lcmtypes/world_truth_t.hpp"
#include "scenarios/scenario.h"
#include "sim/carried_bar.h"
#include "sim/commanded_flight.h"
#include "sim/path.h"
#include "sim/rigid_flight.h"
#include "sim/rotors.h"

namespace windhover {

/// All aircraft of a scenario, moving through simulated time.
class World {
 public:
  /// At time 0.
  /// @throws ConfigError if a trajectory cannot be used or is shorter than the run.
  explicit World(const Scenario& scenario);

  /// Moves everything on. @pre utime is not before the present.
  /// @throws RunInvalid if an aircraft's state is no longer finite.
  void AdvanceTo(Utime utime);

  /// What the aircraft at `position` in the scenario does from now on, if it is commanded.
  /// @throws std::invalid_argument if the command is not finite or faster than 100 m/s; the
  /// dynamics never see it.
  void Command(int position, const FlightCommand& command);

  bool IsCommanded(int position) const { return bodies_[position].path == nullptr; }
  int size() const { return static_cast<int>(bodies_.size()); }
  Utime utime() const { return utime_; }
  const Kinematics& State(int position) const { return bodies_[position].state; }

  /// All of them, in the scenario's order.
  std::vector<Kinematics> States() const;

  /// The truth of now, sorted by id.
  world_truth_t Truth() const;

 private:
  struct Body {
    int id;
    std::unique_ptr<Path> path;          ///< Null: flies under `command`.
    std::unique_ptr<RigidFlight> rigid;  ///< Null: kinematic, on `path` or by `flight`.
    CommandedFlight flight;
    FlightCommand command;
    Rotors rotors;
    Kinematics state;
    RotorsTurning turning;
    std::optional<CarriedBar> bar;  ///< Of the rig, if it carries one that bends.
  };

  static void Advance(Body& body, Utime from, Utime to);

  std::vector<Body> bodies_;
  Utime utime_ = 0;
};

/// Writes place, attitude and their derivatives of an aircraft into its truth.
void SetState(const Kinematics& state, uav_truth_t* truth);

/// Ticks of a run.
int NumberOfTicks(const Scenario& scenario);

}  // namespace windhover
