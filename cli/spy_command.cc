#include <cstdlib>
#include <filesystem>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/command.h"
#include "cli/tool.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

const fs::path kJars = "/usr/share/java";
constexpr const char* kPackages = "default-jdk liblcm-bin liblcm-java libjchart2d-java";

int MissingForSpy(const std::string& what) {
  fmt::print(stderr, "windhover: error: spy needs {}\n  apt-get install {}\n", what, kPackages);
  return kEnvironmentMissing;
}

fs::path CacheFolder() {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  const char* home = std::getenv("HOME");
  const fs::path base = cache != nullptr  ? fs::path(cache)
                        : home != nullptr ? fs::path(home) / ".cache"
                                          : fs::temp_directory_path();
  return base / "windhover" / WINDHOVER_VERSION;
}

std::vector<std::string> FilesIn(const fs::path& folder, const std::string& extension) {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == extension) files.push_back(entry.path().string());
  }
  return files;
}

bool IsNewerThan(const fs::path& jar, const std::vector<std::string>& sources) {
  if (!fs::exists(jar)) return false;
  for (const std::string& source : sources) {
    if (fs::last_write_time(source) > fs::last_write_time(jar)) return false;
  }
  return true;
}

// Java classes of our messages in one jar; false if a tool failed.
bool MakeTypesJar(const fs::path& jar) {
  const std::vector<std::string> types = FilesIn(WINDHOVER_LCMTYPES_DIR, ".lcm");
  if (IsNewerThan(jar, types)) return true;
  const fs::path java = jar.parent_path() / "java";
  fs::remove_all(java);
  fs::create_directories(java);
  std::vector<std::string> generate = {"lcm-gen", "-j", "--jpath", java.string()};
  generate.insert(generate.end(), types.begin(), types.end());
  if (RunTool(generate) != 0) return false;
  std::vector<std::string> compile = {"javac", "-nowarn", "-cp", (kJars / "lcm.jar").string()};
  const std::vector<std::string> sources = FilesIn(java, ".java");
  compile.insert(compile.end(), sources.begin(), sources.end());
  return RunTool(compile) == 0 &&
         RunTool({"jar", "cf", jar.string(), "-C", java.string(), "."}) == 0;
}

// Debian's lcm-spy passes an option that Java no longer knows, so its class is started directly.
int Spy(const std::string& url, bool only_build) {
  for (const char* tool : {"java", "javac", "jar", "lcm-gen"}) {
    if (FindTool(tool).empty()) return MissingForSpy(tool);
  }
  std::string class_path;
  for (const char* name : {"lcm.jar", "jchart2d.jar", "jide-oss.jar", "xmlgraphics-commons.jar"}) {
    if (!fs::exists(kJars / name)) return MissingForSpy((kJars / name).string());
    class_path += (kJars / name).string() + ":";
  }
  const fs::path jar = CacheFolder() / "windhover_types.jar";
  if (!MakeTypesJar(jar)) return MissingForSpy("a working JDK");
  if (only_build) {
    fmt::print("{}\n", jar.string());
    return kPass;
  }
  if (std::getenv("DISPLAY") == nullptr) {
    fmt::print(stderr, "windhover: error: spy needs a screen: DISPLAY is not set\n");
    return kEnvironmentMissing;
  }
  if (!url.empty()) setenv("LCM_DEFAULT_URL", url.c_str(), 1);
  BecomeTool(
      {"java", "-Djava.net.preferIPv4Stack=true", "-cp", class_path + jar.string(), "lcm.spy.Spy"});
  return MissingForSpy("java");
}

}  // namespace

void AddSpyCommand(CLI::App& app, CommandAction* chosen) {
  struct Options {
    std::string url;
    bool only_build = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("spy", "lcm-spy with our message types, on a stock Debian");
  command->add_option("--lcm-url", options->url,
                      "bus to look at, as `windhover run` prints it; default LCM_DEFAULT_URL");
  command->add_flag("--build-only", options->only_build,
                    "only build the jar of message types and print where it is");
  command->footer("Example: windhover spy --lcm-url tcpq://127.0.0.1:7700");
  command->callback([=] { *chosen = [=] { return Spy(options->url, options->only_build); }; });
}

}  // namespace windhover
