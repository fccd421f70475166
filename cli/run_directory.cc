#include "cli/run_directory.h"

#include <array>

#include <fmt/format.h>

#include "common/config/fields.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

constexpr std::array kContents = {"resolved.yaml", "manifest.json", "run.lcm",   "estimates.csv",
                                  "swarm.csv",     "score.json",    "junit.xml", "report.html",
                                  "timing.json",   "frames",        "logs"};

bool IsRunDirectory(const fs::path& folder) { return fs::exists(folder / "resolved.yaml"); }

fs::path MakeNumbered(const fs::path& parent, const std::string& name) {
  fs::create_directories(parent);
  for (int n = 1;; ++n) {
    const fs::path folder = parent / fmt::format("{}-{}", name, n);
    if (fs::create_directory(folder)) return folder;  // False where it exists: try the next.
  }
}

}  // namespace

fs::path MakeRunDirectory(const std::string& scenario_file, const std::string& out) {
  if (out.empty()) return MakeNumbered("runs", fs::path(scenario_file).stem().string());
  std::error_code error;
  if (fs::exists(out) && !fs::is_directory(out)) {
    throw ConfigError(fmt::format("--out must be a folder (found the file '{}')", out));
  }
  if (fs::exists(out) && !fs::is_empty(out) && !IsRunDirectory(out)) {
    throw ConfigError(fmt::format(
        "--out must be empty, new, or the folder of a run (found other files in '{}')", out));
  }
  for (const char* name : kContents) fs::remove_all(fs::path(out) / name);
  fs::create_directories(out, error);
  if (error) {
    throw ConfigError(fmt::format("--out must be a folder that can be made (found '{}': {})", out,
                                  error.message()));
  }
  return out;
}

}  // namespace windhover
