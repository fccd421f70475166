#include "sim/sim_node.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "common/bus/channels.h"
#include "common/bus/stage_status.h"
#include "common/bus/truth_channels.h"
#include "common/process/process.h"

namespace windhover {
namespace {

std::vector<int> IdsOf(const Scenario& scenario) {
  std::vector<int> ids;
  for (const Aircraft& aircraft : scenario.aircraft) ids.push_back(aircraft.self.id);
  return ids;
}

}  // namespace

std::vector<std::string> PeersOf(const ExecutionConfig& execution) {
  std::vector<std::string> peers;
  const auto add = [&](const char* kind, int n) {
    for (int i = 0; i < n; ++i) peers.push_back(fmt::format("{}-{}", kind, i));
  };
  add("render", execution.render_processes);
  add("estimator", execution.estimator_processes);
  add("swarm", execution.swarm_processes);
  return peers;
}

SimNode::SimNode(const Scenario& scenario, const SimOptions& options, Bus& bus)
    : scenario_(scenario),
      options_(options),
      bus_(bus),
      world_(scenario),
      sensors_(scenario),
      uwb_(scenario),
      recorder_(bus, options.log_file, IdsOf(scenario), options.pixels),
      lockstep_(bus, options.run_id, PeersOf(scenario.execution), scenario.execution.deadline_s),
      imu_clock_(scenario.nav.imu_rate_hz) {
  for (int i = 0; i < world_.size(); ++i) {
    if (!world_.IsCommanded(i)) continue;
    bus.Subscribe<velocity_command_t>(
        channel::VelocityCommand(scenario.aircraft[i].self.id),
        [this, i](const velocity_command_t& command) { commands_[i] = command; });
  }
}

RunOutcome SimNode::Run() {
  RunOutcome outcome;
  run_header_t header{};
  header.version = WINDHOVER_VERSION;
  header.resolved_yaml = LogHeaderYaml(scenario_);
  recorder_.WriteHeader(header);
  try {
    RunTicks();
    outcome.valid = true;
  } catch (const RunInvalid& e) {
    outcome.culprit = e.culprit;
    outcome.reason = e.reason;
  } catch (const std::exception& e) {  // The bus is gone, or a message on it is malformed.
    outcome.reason = e.what();
  }
  run_end_t end{};
  end.utime = world_.utime();
  end.n_ticks = outcome.n_ticks = n_ticks_;
  end.valid = outcome.valid ? 1 : 0;
  end.reason = outcome.culprit.empty() ? outcome.reason
                                       : fmt::format("{}: {}", outcome.culprit, outcome.reason);
  recorder_.WriteEnd(end);
  EndPeers(&outcome);
  outcome.status.push_back(OwnStatus());
  return outcome;
}

void SimNode::EndPeers(RunOutcome* outcome) {
  if (outcome->valid) {
    outcome->status = lockstep_.End();
    return;
  }
  // Peers of a run that failed may be gone, and the bus with them: nothing is worth waiting for.
  try {
    lockstep_.End(/*timeout_s=*/0);
  } catch (const std::exception&) {
  }
}

void SimNode::RunTicks() {
  lockstep_.WaitForPeers(options_.peers_timeout_s);
  Rehearse();
  const int n = NumberOfTicks(scenario_);
  const auto start = std::chrono::steady_clock::now();
  for (int tick = 0; tick < n; ++tick) {
    if (StopRequested()) throw RunInvalid("", "interrupted");
    RunTick(tick);
    ++n_ticks_;
    if (options_.on_tick) options_.on_tick(tick, n);
    if (options_.realtime) {
      std::this_thread::sleep_until(
          start + std::chrono::microseconds(UtimeOfTick(tick + 1, scenario_.frame_rate_hz)));
    }
  }
}

void SimNode::Rehearse() {
  tick_t tick{};
  tick.tick = -1;
  tick.utime = UtimeOfTick(-1, scenario_.frame_rate_hz);
  tick.phase = tick_t::PHASE_REHEARSAL;
  PublishState(tick);
  lockstep_.Step(tick);
  recorder_.WriteTick(tick);
  commands_.clear();
}

void SimNode::RunTick(int number) {
  tick_t tick{};
  tick.tick = number;
  tick.utime = UtimeOfTick(number, scenario_.frame_rate_hz);
  tick.phase = tick_t::PHASE_RUN;
  {
    const auto scope = timer_.Start("sim");
    PublishImuUntil(tick.utime);
    world_.AdvanceTo(tick.utime);
    PublishState(tick);
  }
  {
    const auto scope = timer_.Start("wait");
    lockstep_.Step(tick);
  }
  const auto scope = timer_.Start("record");
  recorder_.WriteTick(tick);
  ApplyCommands(tick);
}

void SimNode::PublishImuUntil(Utime utime) {
  while (const auto sample = imu_clock_.Next(utime)) {
    world_.AdvanceTo(sample->utime);
    for (int i = 0; i < world_.size(); ++i) {
      bus_.Publish(channel::Imu(scenario_.aircraft[i].self.id),
                   sensors_.Imu(world_, i, sample->number));
    }
  }
}

void SimNode::PublishState(const tick_t& tick) {
  world_truth_t truth = world_.Truth();
  truth.utime = tick.utime;  // The rehearsal comes before the world's time 0.
  bus_.Publish(channel::kUavTruth, truth);
  uwb_.Observe(world_.utime(), world_.States());
  for (int i = 0; i < world_.size(); ++i) {
    const int id = scenario_.aircraft[i].self.id;
    nav_state_t nav = sensors_.Nav(world_, i, tick.tick);
    uwb_t uwb = uwb_.Report(i, tick.tick);
    nav.utime = uwb.utime = tick.utime;
    bus_.Publish(channel::NavState(id), nav);
    bus_.Publish(channel::Uwb(id), uwb);
  }
}

std::string SimNode::SwarmProcessOf(int position) const {
  return fmt::format("swarm-{}", position % scenario_.execution.swarm_processes);
}

void SimNode::ApplyCommands(const tick_t& tick) {
  for (int i = 0; i < world_.size(); ++i) {
    if (!world_.IsCommanded(i)) continue;
    const auto name = [&] { return channel::VelocityCommand(scenario_.aircraft[i].self.id); };
    const auto found = commands_.find(i);
    if (found == commands_.end()) {
      throw RunInvalid(SwarmProcessOf(i),
                       fmt::format("tick {}: no command on {}", tick.tick, name()));
    }
    const velocity_command_t command = found->second;
    commands_.erase(found);  // Whoever sends none next time has none.
    if (command.utime != tick.utime) {
      throw RunInvalid(SwarmProcessOf(i),
                       fmt::format("tick {}: the command on {} is of utime {}, not {}", tick.tick,
                                   name(), command.utime, tick.utime));
    }
    try {
      world_.Command(i, {Eigen::Vector3d(command.v_WB_mps), command.yaw_rate_radps});
    } catch (const std::invalid_argument& e) {
      throw RunInvalid(SwarmProcessOf(i),
                       fmt::format("tick {}: {}: {}", tick.tick, name(), e.what()));
    }
  }
}

status_t SimNode::OwnStatus() const { return StatusOf("sim", timer_); }

}  // namespace windhover
