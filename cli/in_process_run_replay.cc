#include "cli/in_process_run_replay.h"

#include <cstdlib>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <unistd.h>

#include "cli/process_group.h"
#include "cli/process_run.h"
#include "cli/progress.h"
#include "common/bus/bus.h"
#include "common/bus/run_log.h"
#include "common/bus/tick_client.h"
#include "common/bus/truth_channels.h"
#include "estimator/estimator_node.h"
#include "lcmtypes/run_end_t.hpp"
#include "lcmtypes/run_header_t.hpp"
#include "render/render_node.h"
#include "sim/lockstep.h"
#include "sim/recorder.h"

namespace windhover {
namespace {

using std::chrono::milliseconds;

constexpr std::int64_t kRunId = 1;
constexpr double kPeersTimeout_s = 30;

// What sim and swarm said; the rest is said again.
bool IsInput(const std::string& channel) {
  for (const char* prefix : {"UAV_TRUTH", "NAV_STATE_", "IMU_", "UWB_", "VELOCITY_COMMAND_"}) {
    if (channel.starts_with(prefix)) return true;
  }
  return false;
}

// The bus of a replay: in this process, or a hub where somebody else's estimator takes part.
class ReplayBus {
 public:
  explicit ReplayBus(const ReplayOptions& options) : logs_(options.out / "logs") {
    if (options.estimator_command.empty()) {
      bus_.emplace("memq://");
      return;
    }
    processes_.emplace(logs_);
    processes_->Start({"hub", ProgramFolder() / "windhover-hub", {}, true});
    std::string url;
    while (url.empty() && !processes_->Running().empty()) {
      for (const ProcessEvent& event : processes_->Wait(milliseconds(1000))) url += event.line;
    }
    setenv("LCM_DEFAULT_URL", url.c_str(), 1);
    bus_.emplace(url);
    const std::string arguments =
        fmt::format(" '{}' --lcm-url {} --run-id {} --share 0/1",
                    (options.out / "resolved.yaml").string(), url, kRunId);
    processes_->Start({"estimator-0", "/bin/sh", {"-c", options.estimator_command + arguments}});
  }

  Bus& bus() { return *bus_; }

  /// @throws RunInvalid if a process has ended.
  void Check() {
    if (!processes_) return;
    for (const ProcessEvent& event : processes_->Wait(milliseconds(0))) {
      if (event.kind != ProcessEvent::Kind::kExit) continue;
      const std::filesystem::path log = logs_ / (event.process + ".log");
      throw RunInvalid(event.process,
                       fmt::format("{}; see {}", DescribeExit(event.status), log.string()));
    }
  }

 private:
  std::filesystem::path logs_;
  std::optional<ProcessGroup> processes_;
  std::optional<Bus> bus_;
};

class Replay {
 public:
  Replay(const Scenario& scenario, const ReplayOptions& options)
      : scenario_(scenario),
        options_(options),
        connection_(options),
        recorder_(connection_.bus(), options.out / "run.lcm", IdsOf(scenario),
                  RecordedPixels::kNone),
        lockstep_(connection_.bus(), kRunId, {"render-0", "estimator-0"},
                  scenario.execution.deadline_s),
        render_client_(connection_.bus(), "render-0", kRunId),
        render_(scenario, {}, options.threads, render_client_),
        progress_(isatty(STDERR_FILENO) != 0) {
    if (!options.estimator_command.empty()) return;
    estimator_client_.emplace(connection_.bus(), "estimator-0", kRunId);
    estimator_.emplace(scenario.ForAircraft(), ProcessShare{}, *estimator_client_);
  }

  int Run() {
    lockstep_.CheckWhileWaiting([this] { connection_.Check(); });
    lockstep_.WaitForPeers(kPeersTimeout_s);
    RunLogReader log(options_.log);
    std::optional<LogEvent> event = log.Next();
    while (event) {
      if (event->channel == channel::kRunHeader) {
        WriteHeader(log.DecodeEvent<run_header_t>(*event));
        event = log.Next();
      } else if (event->channel == channel::kRunEnd) {
        recorder_.WriteEnd(log.DecodeEvent<run_end_t>(*event));
        event = log.Next();
      } else {
        event = RunTick(log, *event);
      }
    }
    lockstep_.CheckWhileWaiting([] {});  // Whoever has said his last may leave.
    lockstep_.End(/*timeout_s=*/1);
    return n_ticks_;
  }

 private:
  static std::vector<int> IdsOf(const Scenario& scenario) {
    std::vector<int> ids;
    for (const Aircraft& aircraft : scenario.aircraft) ids.push_back(aircraft.self.id);
    return ids;
  }

  void WriteHeader(run_header_t header) {
    header.resolved_yaml = LogHeaderYaml(scenario_);
    recorder_.WriteHeader(header);
  }

  // Replays one tick, which begins with `event`; returns the first event of the next.
  std::optional<LogEvent> RunTick(RunLogReader& log, LogEvent event) {
    tick_t tick{};
    tick.utime = event.utime;
    tick.tick = n_ticks_;
    tick.phase = tick_t::PHASE_RUN;
    std::optional<LogEvent> next = std::move(event);
    while (next && next->utime == tick.utime && next->channel != channel::kRunEnd) {
      if (IsInput(next->channel)) connection_.bus().PublishBytes(next->channel, next->bytes);
      next = log.Next();
    }
    lockstep_.Step(tick);
    recorder_.WriteTick(tick);
    ++n_ticks_;
    progress_.Update(n_ticks_, NumberOfTicks());
    return next;
  }

  int NumberOfTicks() const {
    return static_cast<int>(std::lround(scenario_.duration_s * scenario_.frame_rate_hz));
  }

  const Scenario& scenario_;
  const ReplayOptions& options_;
  ReplayBus connection_;
  Recorder recorder_;
  Lockstep lockstep_;
  TickClient render_client_;
  RenderNode render_;
  std::optional<TickClient> estimator_client_;
  std::optional<EstimatorNode> estimator_;
  Progress progress_;
  int n_ticks_ = 0;
};

// The next event that a replay makes again: pixels are not compared, their digests are.
std::optional<LogEvent> NextComparable(RunLogReader& log) {
  std::optional<LogEvent> event = log.Next();
  while (event && event->channel.starts_with("STEREO_")) event = log.Next();
  return event;
}

void Compare(const ReplayOptions& options, ReplayResult* result) {
  RunLogReader recorded(options.log), replayed(options.out / "run.lcm");
  for (auto a = NextComparable(recorded), b = NextComparable(replayed); a || b;
       a = NextComparable(recorded), b = NextComparable(replayed)) {
    ++result->n_events;
    if (a && b && a->channel == b->channel && a->utime == b->utime && a->bytes == b->bytes) {
      continue;
    }
    const LogEvent& event = a ? *a : *b;
    if (result->n_different++ == 0) {
      result->first_difference =
          fmt::format("{} at {} s", event.channel, static_cast<double>(event.utime) * 1e-6);
    }
  }
}

}  // namespace

ReplayResult ReplayLog(const Scenario& scenario, const ReplayOptions& options) {
  ReplayResult result;
  result.n_ticks = Replay(scenario, options).Run();
  Compare(options, &result);
  return result;
}

Scenario ScenarioOfLog(const std::filesystem::path& log) {
  RunLogReader reader(log);
  const std::optional<LogEvent> event = reader.Next();
  if (!event || event->channel != channel::kRunHeader) {
    throw std::runtime_error(fmt::format("{}: does not begin with a RUN_HEADER", log.string()));
  }
  return ScenarioFromYaml(reader.DecodeEvent<run_header_t>(*event).resolved_yaml,
                          log.string() + "#RUN_HEADER");
}

}  // namespace windhover
