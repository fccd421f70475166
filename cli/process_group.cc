#include "cli/process_group.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace windhover {
namespace {

[[noreturn]] void Fail(const std::string& what) {
  throw std::runtime_error(fmt::format("{}: {}", what, std::strerror(errno)));
}

// Runs in the child between fork and exec: only async-signal-safe calls.
[[noreturn]] void BecomeProgram(char* const* argv, int out, int err, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);  // The parent died before prctl.
  setpgid(0, 0);                        // Ctrl-C on the terminal is for the parent to handle.
  std::signal(SIGPIPE, SIG_DFL);
  dup2(out, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  const int null = open("/dev/null", O_RDONLY);
  dup2(null, STDIN_FILENO);
  execv(argv[0], argv);
  constexpr std::string_view kMessage = "cannot be started\n";
  [[maybe_unused]] const auto ignored = write(STDERR_FILENO, kMessage.data(), kMessage.size());
  _exit(127);
}

// State of a process in /proc: 'R', 'S', 'T' …; '?' if there is none.
char StateOf(pid_t pid) {
  std::ifstream in(fmt::format("/proc/{}/stat", pid));
  std::string text;
  std::getline(in, text);
  const std::size_t name_end = text.rfind(')');  // The name may hold spaces and brackets.
  return name_end == std::string::npos || name_end + 2 >= text.size() ? '?' : text[name_end + 2];
}

}  // namespace

struct ProcessGroup::Child {
  std::string name;
  pid_t pid = -1;
  int pid_fd = -1;
  int log_fd = -1;
  int out_fd = -1;  // Of the pipe from its standard output; -1: that goes to the log.
  std::string partial_line;
  bool running = true;

  ~Child() {
    for (const int fd : {pid_fd, log_fd, out_fd}) {
      if (fd >= 0) close(fd);
    }
  }

  // Takes what the pipe holds; every line also goes to the log.
  void ReadLines(std::vector<ProcessEvent>* events) {
    std::array<char, 65536> buffer;
    while (out_fd >= 0) {
      const ssize_t n = read(out_fd, buffer.data(), buffer.size());
      if (n < 0) return;
      if (n == 0) {
        close(std::exchange(out_fd, -1));
        return;
      }
      const std::string_view text(buffer.data(), static_cast<std::size_t>(n));
      [[maybe_unused]] const auto ignored = write(log_fd, text.data(), text.size());
      partial_line += text;
      for (auto end = partial_line.find('\n'); end != std::string::npos;
           end = partial_line.find('\n')) {
        events->push_back({ProcessEvent::Kind::kLine, name, partial_line.substr(0, end)});
        partial_line.erase(0, end + 1);
      }
    }
  }
};

std::string DescribeExit(int status) {
  if (WIFSIGNALED(status)) {
    return fmt::format("was killed by signal {} ({})", WTERMSIG(status),
                       strsignal(WTERMSIG(status)));
  }
  return fmt::format("ended with exit status {}", WEXITSTATUS(status));
}

ProcessGroup::ProcessGroup(std::filesystem::path log_folder) : log_folder_(std::move(log_folder)) {
  std::filesystem::create_directories(log_folder_);
}

ProcessGroup::~ProcessGroup() { KillAll(); }

void ProcessGroup::Start(const ProcessSpec& spec) {
  if (access(spec.program.c_str(), X_OK) != 0) Fail(spec.program.string());
  auto child = std::make_unique<Child>();
  child->name = spec.name;
  const std::filesystem::path log = log_folder_ / (spec.name + ".log");
  child->log_fd = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0644);
  if (child->log_fd < 0) Fail(log.string());
  std::array<int, 2> ends = {-1, -1};
  if (spec.report_lines && pipe2(ends.data(), O_CLOEXEC) != 0) Fail("pipe");
  child->out_fd = ends[0];
  if (ends[0] >= 0) fcntl(ends[0], F_SETFL, O_NONBLOCK);

  std::vector<std::string> words = {spec.program.string()};
  words.insert(words.end(), spec.arguments.begin(), spec.arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const pid_t parent = getpid();
  child->pid = fork();
  if (child->pid < 0) Fail("fork");
  if (child->pid == 0) {
    BecomeProgram(argv.data(), spec.report_lines ? ends[1] : child->log_fd, child->log_fd, parent);
  }
  if (ends[1] >= 0) close(ends[1]);
  child->pid_fd = static_cast<int>(syscall(SYS_pidfd_open, child->pid, 0));
  const bool has_fd = child->pid_fd >= 0;
  children_.push_back(std::move(child));
  if (!has_fd) Fail("pidfd_open");
}

std::vector<ProcessEvent> ProcessGroup::Wait(std::chrono::milliseconds timeout) {
  std::vector<pollfd> fds;
  for (const auto& child : children_) {
    if (child->running) fds.push_back({child->pid_fd, POLLIN, 0});
    if (child->out_fd >= 0) fds.push_back({child->out_fd, POLLIN, 0});
  }
  // Interrupted by a signal is as good as a time-out: the caller looks whether to stop.
  poll(fds.data(), fds.size(), static_cast<int>(timeout.count()));
  // Ends are taken note of first and told last: what any process said before another ended (that
  // the run is over, say) is heard before it.
  std::vector<ProcessEvent> ends, events;
  for (const auto& child : children_) {
    if (child->running) Reap(*child, &ends);
  }
  for (const auto& child : children_) child->ReadLines(&events);
  events.insert(events.end(), ends.begin(), ends.end());
  return events;
}

void ProcessGroup::Reap(Child& child, std::vector<ProcessEvent>* ends) {
  int status = 0;
  rusage usage{};
  if (wait4(child.pid, &status, WNOHANG, &usage) != child.pid) return;
  child.running = false;
  peak_rss_mib_[child.name] = static_cast<double>(usage.ru_maxrss) / 1024;
  ends->push_back({ProcessEvent::Kind::kExit, child.name, "", status});
}

std::vector<std::string> ProcessGroup::Running() const {
  std::vector<std::string> names;
  for (const auto& child : children_) {
    if (child->running) names.push_back(child->name);
  }
  return names;
}

std::vector<std::string> ProcessGroup::Stopped() const {
  std::vector<std::string> names;
  for (const auto& child : children_) {
    const char state = child->running ? StateOf(child->pid) : '?';
    if (state == 'T' || state == 't') names.push_back(child->name);
  }
  return names;
}

void ProcessGroup::Signal(const std::string& process, int signal) {
  for (const auto& child : children_) {
    if (child->running && child->name == process) kill(child->pid, signal);
  }
}

void ProcessGroup::KillAll() {
  for (const auto& child : children_) {
    if (child->running) kill(child->pid, SIGKILL);
  }
  for (const auto& child : children_) {
    if (!child->running) continue;
    rusage usage{};
    int status = 0;
    while (wait4(child->pid, &status, 0, &usage) < 0 && errno == EINTR) {
    }
    child->running = false;
    peak_rss_mib_[child->name] = static_cast<double>(usage.ru_maxrss) / 1024;
  }
}

}  // namespace windhover
