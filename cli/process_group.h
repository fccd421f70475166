#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <sys/types.h>

namespace windhover {

/// A process to start.
struct ProcessSpec {
  std::string name;  ///< "render-0"; its output goes to NAME.log.
  std::filesystem::path program;
  std::vector<std::string> arguments;
  bool report_lines = false;  ///< Its standard output comes as lines from Wait().
};

/// Something that happened in a ProcessGroup.
struct ProcessEvent {
  enum class Kind { kLine, kExit };
  Kind kind;
  std::string process;
  std::string line;  ///< kLine: what it printed.
  int status = 0;    ///< kExit: as of waitpid.
};

/// "was killed by signal 9 (Killed)" or "ended with exit status 3".
std::string DescribeExit(int status);

/// The child processes of a run. None outlives this object, nor this process, however it ends.
class ProcessGroup {
 public:
  explicit ProcessGroup(std::filesystem::path log_folder);
  ~ProcessGroup();
  ProcessGroup(const ProcessGroup&) = delete;

  /// @throws std::runtime_error naming the program if it cannot be started.
  void Start(const ProcessSpec& spec);

  /// Waits up to `timeout` for lines and exits. What was said before an exit comes before it.
  std::vector<ProcessEvent> Wait(std::chrono::milliseconds timeout);

  std::vector<std::string> Running() const;
  /// Running processes that are stopped (SIGSTOP, a debugger).
  std::vector<std::string> Stopped() const;

  void Signal(const std::string& process, int signal);
  /// SIGKILL to all, and waits for their end.
  void KillAll();

  /// Largest resident memory of each process that has ended.
  const std::map<std::string, double>& peak_rss_mib() const { return peak_rss_mib_; }

 private:
  struct Child;

  void Reap(Child& child, std::vector<ProcessEvent>* ends);

  std::filesystem::path log_folder_;
  std::vector<std::unique_ptr<Child>> children_;
  std::map<std::string, double> peak_rss_mib_;
};

}  // namespace windhover
