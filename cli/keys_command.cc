#include <algorithm>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/command.h"
#include "common/config/key_lister.h"
#include "scenarios/scenario.h"

namespace windhover {
namespace {

bool IsIn(const std::string& path, const std::string& section) {
  return section.empty() || path == section || path.starts_with(section + ".");
}

// Columns as a terminal shows them: µ and … are one column but several bytes.
std::size_t Columns(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string Padded(const std::string& text, std::size_t width) {
  return text + std::string(width > Columns(text) ? width - Columns(text) : 0, ' ');
}

std::string Allowed(const KeyDescription& key) {
  if (key.type == "word" || key.limits.empty()) return key.limits.empty() ? key.type : key.limits;
  return key.type + ", " + key.limits;
}

void Print(const std::vector<KeyDescription>& keys) {
  std::size_t path_width = 0, unit_width = 4;
  for (const KeyDescription& key : keys) {
    path_width = std::max(path_width, key.path.size());
    unit_width = std::max(unit_width, Columns(key.unit));
  }
  for (const KeyDescription& key : keys) {
    const std::string path = Padded(key.path, path_width);
    if (key.type == "section" || key.type == "list") {
      fmt::print("\n{}  {}  -- {}\n", path, Padded("", unit_width), key.meaning);
      continue;
    }
    fmt::print("{}  {}  {}\n", path, Padded(key.unit, unit_width), key.meaning);
    fmt::print("{}  {}    {}{}\n", std::string(path_width, ' '), Padded("", unit_width),
               Allowed(key), key.initial.empty() ? "" : "; default " + key.initial);
  }
}

int ListScenarioKeys(const std::string& section) {
  std::vector<KeyDescription> keys = ListKeys<Scenario>();
  std::erase_if(keys, [&](const KeyDescription& key) { return !IsIn(key.path, section); });
  if (keys.empty()) {
    throw ConfigError(fmt::format(
        "SECTION must be a key of a scenario, such as rig or aircraft.N (found '{}')", section));
  }
  Print(keys);
  return kPass;
}

}  // namespace

void AddKeysCommand(CLI::App& app, CommandAction* chosen) {
  auto section = std::make_shared<std::string>();
  CLI::App* command =
      app.add_subcommand("keys", "every scenario key: meaning, unit, limits, default");
  command->add_option("SECTION", *section, "only these keys");
  command->footer("Example: windhover keys rig.misalignment");
  command->callback([=] { *chosen = [=] { return ListScenarioKeys(*section); }; });
}

}  // namespace windhover
