#include <iostream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "cli/command.h"
#include "cli/progress.h"
#include "cli/reproduce.h"
#include "cli/run_directory.h"
#include "common/config/fields.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> tables;
  std::string out;
  int n_seeds = 12;
  bool quick = false;
};

std::vector<ReproducedTable> Chosen(const std::vector<std::string>& names) {
  if (names.empty()) return ReproducedTables();
  std::vector<ReproducedTable> chosen;
  std::vector<std::string> known;
  for (const ReproducedTable& table : ReproducedTables()) known.push_back(table.name);
  for (const std::string& name : names) {
    const auto it = std::find(known.begin(), known.end(), name);
    if (it == known.end()) {
      throw ConfigError(
          fmt::format("TABLE must be one of {} (found '{}')", fmt::join(known, ", "), name));
    }
    chosen.push_back(ReproducedTables()[static_cast<std::size_t>(it - known.begin())]);
  }
  return chosen;
}

int ReproduceAll(const Options& options) {
  const std::vector<ReproducedTable> tables = Chosen(options.tables);
  fs::create_directories(options.out);
  for (const ReproducedTable& table : tables) {
    Progress progress(isatty(STDERR_FILENO) != 0);
    ReproduceOptions how;
    how.n_seeds = options.quick ? 2 : options.n_seeds;
    how.scenarios = WINDHOVER_SCENARIOS_DIR;
    how.scratch = fs::path(options.out) / ("flying_" + table.name);
    how.on_flight = [&](int done, int total) { progress.Update(done, total); };
    fs::create_directories(how.scratch);
    const nlohmann::ordered_json result = Reproduce(table, how);
    fs::remove_all(how.scratch);
    ReplaceFile(fs::path(options.out) / (table.name + ".json"), result.dump(2) + "\n");
    std::cout << '\n' << ReproducedText(result);
  }
  return kPass;
}

}  // namespace

void AddReproduceCommand(CLI::App& app, CommandAction* chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("reproduce", "the paper's tables, ours beside theirs");
  command->add_option("TABLE", options->tables, "lenses, audits; default all");
  command->add_option("--out", options->out, "folder for TABLE.json")->required();
  command->add_option("--seeds", options->n_seeds, "data sets to make of each row")
      ->check(CLI::Range(1, 1000));
  command->add_flag("--quick", options->quick, "two data sets: for a first look");
  command->footer("Example: windhover reproduce lenses --out reproduced --seeds 12");
  command->callback([=] { *chosen = [=] { return ReproduceAll(*options); }; });
}

}  // namespace windhover
