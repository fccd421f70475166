#include "cli/tool.h"

#include <cerrno>
#include <cstdlib>
#include <sstream>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace windhover {
namespace {

std::vector<char*> Argv(std::vector<std::string>& words) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  return argv;
}

}  // namespace

std::filesystem::path FindTool(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::filesystem::path file = std::filesystem::path(folder) / name;
    if (access(file.c_str(), X_OK) == 0) return file;
  }
  return {};
}

std::filesystem::path OwnProgram(const std::string& name) {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / name;
}

int RunTool(const std::vector<std::string>& words, bool silent) {
  std::vector<std::string> copy = words;
  const std::vector<char*> argv = Argv(copy);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (silent) {
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  }
  pid_t pid = -1;
  const int error = posix_spawnp(&pid, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return 127;
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void BecomeTool(std::vector<std::string> words) { execvp(words[0].c_str(), Argv(words).data()); }

std::vector<std::string> MissingPackages(const std::vector<std::string>& packages) {
  std::vector<std::string> missing;
  if (FindTool("dpkg-query").empty()) return missing;
  for (const std::string& package : packages) {
    const std::vector<std::string> query = {"dpkg-query", "-W", "-f=${db:Status-Status}", package};
    if (RunTool(query, /*silent=*/true) != 0) missing.push_back(package);
  }
  return missing;
}

}  // namespace windhover
