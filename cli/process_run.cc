#include "cli/process_run.h"

#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <random>
#include <stdexcept>

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/process_group.h"
#include "cli/progress.h"
#include "common/process/process.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using Json = nlohmann::ordered_json;

constexpr milliseconds kPoll{50};
// Once one process has died, others follow because of it: the first cause is looked for among
// all deaths of this time.
constexpr milliseconds kGrace{150};
constexpr double kStartTime_s = 60;  // Loading and the rehearsal, before the first tick.

std::int64_t NewRunId() {
  std::random_device device;
  return (static_cast<std::int64_t>(device() & 0x3fffffff) << 20) | (device() & 0xfffff) | 1;
}

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

class ProcessRun {
 public:
  ProcessRun(const Scenario& scenario, const fs::path& run_dir, const RunOptions& options)
      : scenario_(scenario),
        run_dir_(run_dir),
        options_(options),
        run_id_(NewRunId()),
        group_(run_dir / "logs"),
        progress_(isatty(STDERR_FILENO) != 0) {}

  RunSummary Run() {
    const std::string url = OpenBus();
    if (!over_) {
      setenv("LCM_DEFAULT_URL", url.c_str(), 1);
      if (!options_.quiet) fmt::print(stderr, "windhover: bus {} (LCM_DEFAULT_URL)\n", url);
      StartPeers();
    }
    while (!over_) Watch();
    if (summary_.n_ticks > 0) summary_.wall_s = SecondsSince(first_tick_);
    Close();
    summary_.peak_rss_mib = group_.peak_rss_mib();
    return summary_;
  }

 private:
  std::string OpenBus() {
    if (options_.bus == "udpm") {
      // A port of this run's own: LCM keeps runs apart by port, not by group.
      return fmt::format("udpm://239.255.76.67:{}?ttl=0&recv_buf_size=4194304",
                         20000 + run_id_ % 10000);
    }
    if (!options_.bus.empty() && options_.bus != "tcpq") return options_.bus;
    group_.Start({"hub", ProgramFolder() / "windhover-hub", {}, true});
    for (const auto start = Clock::now(); !over_ && SecondsSince(start) < kStartTime_s;) {
      for (const ProcessEvent& event : group_.Wait(kPoll)) {
        if (event.kind == ProcessEvent::Kind::kLine) return event.line;
        Blame(event.process, DescribeExit(event.status));
      }
      if (StopRequested()) Interrupt();
    }
    if (!over_) Blame("hub", "did not open a bus");
    return "";
  }

  void StartPeers() {
    const ExecutionConfig& execution = scenario_.execution;
    if (options_.estimator.empty()) {
      Start("estimator", execution.estimator_processes);
    } else {
      StartOtherEstimator();
    }
    Start("swarm", execution.swarm_processes);
    Start("render", execution.render_processes);
    std::vector<std::string> arguments = Arguments(0, 1);
    if (options_.realtime) arguments.emplace_back("--realtime");
    group_.Start({"sim", ProgramFolder() / "windhover-sim", arguments, true});
    last_progress_ = Clock::now();
  }

  void Start(const std::string& kind, int count) {
    for (int i = 0; i < count; ++i) {
      group_.Start({fmt::format("{}-{}", kind, i), ProgramFolder() / ("windhover-" + kind),
                    Arguments(i, count)});
    }
  }

  void StartOtherEstimator() {
    std::string command = options_.estimator;
    for (const std::string& word : Arguments(0, 1)) command += fmt::format(" '{}'", word);
    group_.Start({"estimator-0", "/bin/sh", {"-c", command}});
  }

  std::vector<std::string> Arguments(int index, int count) const {
    std::vector<std::string> arguments = {(run_dir_ / "resolved.yaml").string(),
                                          "--run-dir",
                                          run_dir_.string(),
                                          "--run-id",
                                          std::to_string(run_id_),
                                          "--share",
                                          fmt::format("{}/{}", index, count),
                                          "--threads",
                                          std::to_string(options_.threads),
                                          "--record",
                                          options_.record};
    if (options_.preview) arguments.emplace_back("--preview");
    if (options_.frames == "shm") arguments.emplace_back("--share-frames");
    return arguments;
  }

  void Watch() {
    bool died = false;
    for (const ProcessEvent& event : group_.Wait(kPoll)) died |= Take(event);
    if (died) return FindCause();
    if (sim_ended_) {
      over_ = true;
      summary_.valid = true;
      return;
    }
    if (StopRequested()) return Interrupt();
    CheckProgress();
  }

  // True if the event is the end of a process that should not have ended, or ended badly.
  bool Take(const ProcessEvent& event) {
    if (event.kind == ProcessEvent::Kind::kLine) {
      if (event.process == "sim") TakeSimLine(event.line);
      return false;
    }
    if (event.process == "sim" && event.status == 0 && invalid_culprit_.empty()) {
      sim_ended_ = true;
      return false;
    }
    const bool is_done = n_ticks_total_ > 0 && summary_.n_ticks == n_ticks_total_;
    if (event.status == 0 && is_done) return false;  // A peer may leave before sim does.
    deaths_.push_back(event);
    return true;
  }

  void TakeSimLine(const std::string& line) {
    last_progress_ = Clock::now();
    const std::size_t space = line.find(' ');
    const std::string word = line.substr(0, space);
    const std::string rest = space == std::string::npos ? "" : line.substr(space + 1);
    if (word == "tick") {
      TakeTick(rest);
    } else if (word == "invalid") {
      const std::size_t colon = rest.find(": ");
      invalid_culprit_ = rest.substr(0, colon);
      invalid_reason_ = colon == std::string::npos ? rest : rest.substr(colon + 2);
    } else if (word == "status" || word == "counts") {
      const Json json = Json::parse(rest, nullptr, false);
      if (word == "counts" && json.is_object()) summary_.counters = json;
      if (word == "status" && json.is_object() && json.contains("process")) {
        summary_.stages[json.value("process", "")] = json.value("stages", Json::array());
      }
    }
  }

  // "K N": tick K, counted from 0, of N is done.
  void TakeTick(const std::string& text) {
    int tick = 0, total = 0;
    const char* end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, tick);
    if (first.ec != std::errc() || first.ptr == end) return;
    if (std::from_chars(first.ptr + 1, end, total).ec != std::errc()) return;
    if (summary_.n_ticks == 0) first_tick_ = Clock::now();
    summary_.n_ticks = tick + 1;
    n_ticks_total_ = total;
    if (!options_.quiet) progress_.Update(tick + 1, total);
  }

  // One process that was killed, or that stands still, explains everything else; then the hub;
  // then what sim says, which waits for the others; then whoever ended first.
  void FindCause() {
    for (const auto start = Clock::now(); Clock::now() - start < kGrace;) {
      for (const ProcessEvent& event : group_.Wait(kPoll)) Take(event);
    }
    for (const ProcessEvent& death : deaths_) {
      if (WIFSIGNALED(death.status)) return Blame(death.process, DescribeExit(death.status));
    }
    if (BlameStopped()) return;
    const auto is_hub = [](const ProcessEvent& death) { return death.process == "hub"; };
    const bool hub_died = std::any_of(deaths_.begin(), deaths_.end(), is_hub);
    if (hub_died) return Blame("hub", "ended during the run");
    if (!invalid_culprit_.empty()) return Blame(invalid_culprit_, invalid_reason_);
    const ProcessEvent& first = deaths_.front();
    Blame(first.process, DescribeExit(first.status) + LogHint(first.process));
  }

  std::string LogHint(const std::string& process) const {
    return fmt::format("; see {}", (run_dir_ / "logs" / (process + ".log")).string());
  }

  bool BlameStopped() {
    const std::vector<std::string> stopped = group_.Stopped();
    if (stopped.empty()) return false;
    Blame(stopped.front(), "is stopped (SIGSTOP) and answers no more");
    return true;
  }

  // sim has the deadline of a tick itself; this is for when sim, or the bus, stands still.
  void CheckProgress() {
    const double deadline_s = scenario_.execution.deadline_s;
    const double idle_s = SecondsSince(last_progress_);
    if (idle_s < deadline_s + 0.5 || BlameStopped()) return;
    const double limit_s = summary_.n_ticks == 0 ? std::max(kStartTime_s, deadline_s) : deadline_s;
    if (idle_s < limit_s + 1) return;
    if (!invalid_culprit_.empty()) return Blame(invalid_culprit_, invalid_reason_);
    Blame("sim", fmt::format("made no progress for {:.1f} s{}", idle_s, LogHint("sim")));
  }

  void Blame(const std::string& culprit, const std::string& reason) {
    over_ = true;
    summary_.valid = false;
    summary_.culprit = culprit;
    summary_.reason = reason;
  }

  void Interrupt() {
    Blame("windhover", "was interrupted");
    summary_.interrupted = true;
  }

  // Lets sim end its log and the hub its counts, then makes sure that nothing is left.
  void Close() {
    if (summary_.valid) {
      WaitForEnd({"hub"}, milliseconds(3000));
      group_.Signal("hub", SIGTERM);
      WaitForEnd({}, milliseconds(1000));
    } else {
      group_.Signal("sim", SIGTERM);
      WaitForEndOf("sim", milliseconds(400));
    }
    for (const std::string& left : group_.Running()) {
      if (summary_.valid) fmt::print(stderr, "windhover: {} did not end; killed\n", left);
    }
    group_.KillAll();
  }

  // Until no process but `except` runs.
  void WaitForEnd(const std::vector<std::string>& except, milliseconds timeout) {
    const auto start = Clock::now();
    const auto rest = [&] {
      std::vector<std::string> running = group_.Running();
      std::erase_if(running, [&](const std::string& name) {
        return std::count(except.begin(), except.end(), name) > 0;
      });
      return running;
    };
    while (!rest().empty() && Clock::now() - start < timeout) group_.Wait(kPoll);
  }

  void WaitForEndOf(const std::string& process, milliseconds timeout) {
    const auto start = Clock::now();
    const auto runs = [&] {
      const std::vector<std::string> running = group_.Running();
      return std::count(running.begin(), running.end(), process) > 0;
    };
    while (runs() && Clock::now() - start < timeout) {
      for (const ProcessEvent& event : group_.Wait(kPoll)) Take(event);
    }
  }

  const Scenario& scenario_;
  const fs::path run_dir_;
  const RunOptions& options_;
  const std::int64_t run_id_;
  ProcessGroup group_;
  Progress progress_;
  RunSummary summary_;
  bool over_ = false;
  bool sim_ended_ = false;
  int n_ticks_total_ = 0;
  std::string invalid_culprit_, invalid_reason_;  // As sim says.
  std::vector<ProcessEvent> deaths_;
  Clock::time_point last_progress_ = Clock::now();
  Clock::time_point first_tick_{};
};

}  // namespace

RunSummary RunProcesses(const Scenario& scenario, const fs::path& run_dir,
                        const RunOptions& options) {
  return ProcessRun(scenario, run_dir, options).Run();
}

fs::path ProgramFolder() { return fs::read_symlink("/proc/self/exe").parent_path(); }

}  // namespace windhover
