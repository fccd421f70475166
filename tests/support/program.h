#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/temporary_folder.h"

namespace windhover {

inline std::string TextOf(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// A program run by a test; killed at the latest with this object.
class Program {
 public:
  explicit Program(std::vector<std::string> words) {
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ == 0) {
      dup2(open(OutFile().c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
      dup2(open(ErrFile().c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
      execvp(argv[0], argv.data());
      _exit(127);
    }
  }
  ~Program() {
    if (pid_ > 0) kill(pid_, SIGKILL);
    Wait();
  }
  Program(const Program&) = delete;

  pid_t pid() const { return pid_; }
  void Signal(int signal) const { kill(pid_, signal); }

  /// Exit status; 128 + signal if it was killed.
  int Wait() {
    if (pid_ <= 0) return status_;
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return status_;
  }

  std::string Out() const { return TextOf(OutFile()); }
  std::string Err() const { return TextOf(ErrFile()); }

 private:
  std::filesystem::path OutFile() const { return folder_.path() / "out"; }
  std::filesystem::path ErrFile() const { return folder_.path() / "err"; }

  TemporaryFolder folder_;
  pid_t pid_ = -1;
  int status_ = -1;
};

/// A running process.
struct ProcessEntry {
  pid_t pid;
  pid_t parent;
  char state;        ///< 'R', 'S', 'T', 'Z', …
  std::string name;  ///< At most 15 characters.
};

/// Every process of this machine that this one may see.
inline std::vector<ProcessEntry> AllProcesses() {
  std::vector<ProcessEntry> all;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string stat = TextOf(entry.path() / "stat");
    const auto open = stat.find('('), close = stat.rfind(')');
    if (open == std::string::npos || close == std::string::npos) continue;
    ProcessEntry process{};
    process.pid = static_cast<pid_t>(std::strtol(stat.c_str(), nullptr, 10));
    process.name = stat.substr(open + 1, close - open - 1);
    std::istringstream rest(stat.substr(close + 1));
    rest >> process.state >> process.parent;
    all.push_back(process);
  }
  return all;
}

}  // namespace windhover
