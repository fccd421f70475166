#include <CLI/CLI.hpp>

#include "cli/command.h"
#include "cli/process_run.h"
#include "cli/tool.h"

namespace windhover {

void AddMeshInfoCommand(CLI::App& app, CommandAction* chosen) {
  struct Options {
    std::string file;
    bool as_json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("mesh-info", "size, units, winding and materials of a mesh file");
  command->add_option("FILE", options->file, "any mesh that assimp reads")->required();
  command->add_flag("--json", options->as_json, "print JSON");
  command->footer("Example: windhover mesh-info drone.glb");
  command->callback([=] {
    *chosen = [=] {
      std::vector<std::string> words = {ProgramFolder() / "windhover-render",
                                        "--mesh-info=" + options->file};
      if (options->as_json) words.push_back("--json");
      return RunTool(words);
    };
  });
}

}  // namespace windhover
