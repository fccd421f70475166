#include "common/process/isolated.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/config/fields.h"

namespace windhover {
namespace {

constexpr char kDone = 'd', kFailed = 'f';
constexpr rlim_t kMaxMemory = rlim_t{4} << 30;
constexpr std::chrono::seconds kMaxWait{1200};  // For what sleeps.

void WriteAll(int fd, const char* bytes, std::size_t n) {
  while (n > 0) {
    const ssize_t written = write(fd, bytes, n);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) _exit(1);
    bytes += written;
    n -= static_cast<std::size_t>(written);
  }
}

void LimitThisProcess(rlim_t max_cpu_s) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) std::signal(signal, SIG_DFL);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const rlimit cpu{max_cpu_s, max_cpu_s + 1};
  setrlimit(RLIMIT_CPU, &cpu);
#ifndef __SANITIZE_ADDRESS__  // Which maps terabytes.
  const rlimit memory{kMaxMemory, kMaxMemory};
  setrlimit(RLIMIT_AS, &memory);
  dup2(open("/dev/null", O_WRONLY | O_CLOEXEC), STDERR_FILENO);  // Libraries' own words.
#endif
}

[[noreturn]] void RunChild(int fd, rlim_t max_cpu_s, const std::function<std::string()>& work) {
  LimitThisProcess(max_cpu_s);
  std::string answer;
  char status = kDone;
  try {
    answer = work();
  } catch (const std::bad_alloc&) {
    status = kFailed;
    answer = "needs more than 4 GiB of memory";
  } catch (const std::exception& error) {
    status = kFailed;
    answer = error.what();
  } catch (...) {
    status = kFailed;
    answer = "the reader failed without a word";
  }
  WriteAll(fd, &status, 1);
  WriteAll(fd, answer.data(), answer.size());
  _exit(0);
}

// False if the child takes too long.
bool ReadAll(int fd, std::string* answer) {
  const auto deadline = std::chrono::steady_clock::now() + kMaxWait;
  std::array<char, 1 << 16> bytes;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        deadline - std::chrono::steady_clock::now());
    pollfd waiting{.fd = fd, .events = POLLIN, .revents = 0};
    if (left.count() <= 0) return false;
    if (poll(&waiting, 1, static_cast<int>(left.count())) <= 0) continue;
    const ssize_t got = read(fd, bytes.data(), bytes.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return true;
    answer->append(bytes.data(), static_cast<std::size_t>(got));
  }
}

}  // namespace

std::string RunIsolated(std::uintmax_t input_bytes, const std::function<std::string()>& work) {
  const rlim_t max_cpu_s = 5 + (input_bytes >> 20);
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe for a reader");
  const pid_t pid = fork();
  if (pid == 0) {
    close(ends[0]);
    RunChild(ends[1], max_cpu_s, work);
  }
  close(ends[1]);
  std::string answer;
  const bool in_time = pid > 0 && ReadAll(ends[0], &answer);
  close(ends[0]);
  if (pid < 0) throw std::runtime_error("cannot fork a reader");
  if (!in_time) kill(pid, SIGKILL);
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (!in_time || (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)) {
    throw ConfigError(fmt::format("the reader did not come to an end within {} s", max_cpu_s));
  }
  if (WIFSIGNALED(status)) {
    throw ConfigError(fmt::format("the reader crashed (SIG{})", sigabbrev_np(WTERMSIG(status))));
  }
  if (answer.empty() || (WIFEXITED(status) && WEXITSTATUS(status) != 0)) {
    throw ConfigError("the reader ended early");
  }
  const bool failed = answer[0] == kFailed;
  answer.erase(0, 1);
  if (failed) throw ConfigError(answer);
  return answer;
}

}  // namespace windhover
