#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/command.h"
#include "cli/tool.h"

namespace windhover {

void AddTrainDetectorCommand(CLI::App& train, CommandAction* chosen) {
  CLI::App* detector = train.add_subcommand("detector", "a detector, on rendered pictures");
  detector->prefix_command();  // Arguments and --help are the program's own.
  detector->set_help_flag("");
  detector->callback([=] {
    *chosen = [arguments = detector->remaining()] {
      std::vector<std::string> words = {OwnProgram("windhover-train-detector").string()};
      words.insert(words.end(), arguments.begin(), arguments.end());
      BecomeTool(words);
      fmt::print(stderr,
                 "windhover: error: {} cannot be started\n"
                 "  it is built where libtorch-dev is installed: ./cmake/install_dependencies.sh\n",
                 words.front());
      return static_cast<int>(kEnvironmentMissing);
    };
  });
}

}  // namespace windhover
