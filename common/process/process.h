#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace windhover {

/// Which aircraft a process serves when several share the work: every `count`-th, from `index`.
struct ProcessShare {
  int index = 0;
  int count = 1;

  /// `position`: of the aircraft in the scenario's list sorted by id.
  bool Owns(int position) const { return position % count == index; }
};

/// "i/n" with 0 <= i < n; nothing if the text is something else.
std::optional<ProcessShare> ShareFromText(const std::string& text);

/// What every process of a run is told on its command line.
struct ProcessArgs {
  std::string scenario_file;  ///< resolved.yaml of the run.
  std::string url;            ///< LCM provider; default LCM_DEFAULT_URL.
  std::string run_dir;
  std::int64_t run_id = 0;
  ProcessShare share;
  int threads = 1;
  std::string record = "none";  ///< none | jpeg | raw
  bool preview = false;
  bool shares_frames = false;  ///< Pixels travel through shared memory.
};

/// The body of the main() of every process of a run: parses the arguments, runs `body`, turns an
/// exception into `name: error: …` on stderr and an exit status: 0 done, 2 wrong usage or input
/// (ConfigError), 3 anything else, 130 interrupted. `add_options` adds those of this process alone.
int RunProcess(const std::string& name, const std::string& purpose, int argc, char** argv,
               const std::function<void(const ProcessArgs&)>& body,
               const std::function<void(CLI::App&)>& add_options = {});

/// The same for a program whose arguments are others: `app` describes them.
int RunProgram(CLI::App& app, int argc, char** argv, const std::function<void()>& body);

/// True once SIGINT or SIGTERM has arrived; loops run `while (!StopRequested())`.
bool StopRequested();

}  // namespace windhover
