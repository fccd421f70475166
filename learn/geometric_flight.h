#pragma once

#include <memory>
#include <optional>

#include "common/time/sim_time.h"
#include "lcmtypes/nav_state_t.hpp"
#include "lcmtypes/stereo_box_t.hpp"
#include "scenarios/scenario.h"

namespace windhover {

/// One tick of a flight with one rig and one target.
struct FlownFrame {
  int tick = 0;
  Utime utime = 0;
  std::optional<stereo_box_t> box;    ///< What is detected, if anything.
  bool box_is_of_target = false;      ///< Not so far off that a score counts it as false.
  std::optional<double> reference_m;  ///< score.reference; nothing: a score leaves the frame out.
  double range_m = 0;                 ///< True, from the middle of the baseline.
};

/// Flies a flight of a data set (scenarios/dataset.h) without bus, log and estimator: what a run
/// of it with `observe: geometric` puts on the bus and scores, to the bit.
class GeometricFlight {
 public:
  /// @throws std::invalid_argument unless aircraft 0 carries the only rig, aircraft 1 is the only
  /// other one and neither is commanded; ConfigError if a file that it names cannot be used.
  explicit GeometricFlight(const Scenario& flight);
  ~GeometricFlight();

  /// The next tick, if there is one.
  std::optional<FlownFrame> Next();

  /// What the rig's aircraft knows of itself at the tick that Next() gave last.
  nav_state_t Nav() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace windhover
