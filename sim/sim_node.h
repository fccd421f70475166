#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/bus/bus.h"
#include "common/process/stage_timer.h"
#include "lcmtypes/status_t.hpp"
#include "lcmtypes/tick_t.hpp"
#include "lcmtypes/velocity_command_t.hpp"
#include "scenarios/scenario.h"
#include "sim/imu_clock.h"
#include "sim/lockstep.h"
#include "sim/onboard_sensors.h"
#include "sim/recorder.h"
#include "sim/uwb_ranging.h"
#include "sim/world.h"

namespace windhover {

struct SimOptions {
  std::int64_t run_id = 1;
  std::filesystem::path log_file;  ///< Where run.lcm goes.
  RecordedPixels pixels = RecordedPixels::kNone;
  bool realtime = false;  ///< Sleep where the run is ahead of the clock; results do not change.
  double peers_timeout_s = 30;  ///< Wall-clock time in which every peer must have said HELLO.
  std::function<void(int tick, int n_ticks)> on_tick;  ///< Told after each tick; may be empty.
};

/// How a run ended.
struct RunOutcome {
  bool valid = false;
  std::string culprit;  ///< Process to look at first when invalid; may be empty.
  std::string reason;
  int n_ticks = 0;               ///< Completed.
  std::vector<status_t> status;  ///< Of each peer that sent one, and of sim itself.
};

/// Names of the processes that take part in a run besides sim, upstream first: "render-0", ….
std::vector<std::string> PeersOf(const ExecutionConfig& execution);

/// Moves the world and leads the lock-step. Tick k, from 0, is at k / frame_rate_hz; there are
/// duration_s · frame_rate_hz of them, rounded, after a rehearsal (tick -1). In each, for every
/// aircraft i:
///
///     out  UAV_TRUTH, NAV_STATE_i, UWB_i, and every IMU_i sample since the last tick
///     in   VELOCITY_COMMAND_i of those that follow, applied until the next tick
class SimNode {
 public:
  /// Subscribes on `bus`. On memq:// the peers must be on the same bus.
  /// @throws ConfigError if a trajectory cannot be used.
  SimNode(const Scenario& scenario, const SimOptions& options, Bus& bus);
  SimNode(const SimNode&) = delete;

  /// The whole run. Whatever makes it invalid is in the outcome and in the log's RUN_END.
  RunOutcome Run();

 private:
  void RunTicks();
  void EndPeers(RunOutcome* outcome);
  void Rehearse();
  void RunTick(int tick);
  void PublishImuUntil(Utime utime);
  void PublishState(const tick_t& tick);
  void ApplyCommands(const tick_t& tick);
  std::string SwarmProcessOf(int position) const;
  status_t OwnStatus() const;

  Scenario scenario_;
  SimOptions options_;
  Bus& bus_;
  World world_;
  OnboardSensors sensors_;
  UwbRanging uwb_;
  Recorder recorder_;
  std::map<int, velocity_command_t> commands_;  // Latest, by position of the aircraft.
  Lockstep lockstep_;
  StageTimer timer_;
  ImuClock imu_clock_;
  int n_ticks_ = 0;
};

}  // namespace windhover
