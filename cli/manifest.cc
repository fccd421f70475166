#include "cli/manifest.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include "cli/build_info.h"
#include "common/config/value_text.h"
#include "common/file/sha256.h"
#include "scenarios/input_files.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

std::string CpuModel() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("model name"))
      return line.substr(std::min(line.find(':') + 2, line.size()));
  }
  return "";
}

Json Host() {
  utsname names{};
  uname(&names);
  const double page_bytes = static_cast<double>(sysconf(_SC_PAGESIZE));
  const double memory_mib = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * page_bytes / (1 << 20);
  return {{"name", names.nodename},
          {"kernel", names.release},
          {"cpu", CpuModel()},
          {"threads", std::thread::hardware_concurrency()},
          {"memory_mib", static_cast<std::int64_t>(memory_mib)}};
}

// Versions of the Debian packages that results can depend on; those that are installed.
Json Libraries() {
  constexpr const char* kCommand =
      "dpkg-query -W -f '${Package} ${Version}\\n' liblcm1 libopencv-core406 libosmesa6 libllvm15 "
      "libassimp5 libyaml-cpp0.7 libfmt9 libc6 libstdc++6 2>/dev/null";
  Json versions = Json::object();
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(kCommand, "r"), pclose);
  std::array<char, 256> line;
  while (pipe && fgets(line.data(), line.size(), pipe.get()) != nullptr) {
    const std::string text(line.data());
    const std::size_t space = text.find(' ');
    if (space == std::string::npos) continue;
    versions[text.substr(0, space)] = text.substr(space + 1, text.find('\n') - space - 1);
  }
  return versions;
}

Json Inputs(const Scenario& scenario, const std::string& scenario_file) {
  Json inputs = Json::array();
  inputs.push_back({{"key", "scenario"},
                    {"file", std::filesystem::absolute(scenario_file).lexically_normal().string()},
                    {"sha256", Sha256OfFile(scenario_file)}});
  for (const NamedInputFile& input : InputFilesOf(scenario)) {
    inputs.push_back({{"key", input.key},
                      {"file", input.file.absolute},
                      {"sha256", Sha256OfFile(input.file.absolute)}});
  }
  return inputs;
}

std::string UtcNow() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 32> text;
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text.data();
}

// Mean time of a stage in a tick. Processes of one kind work at the same time: the slowest counts.
double StageMs(const RunSummary& summary, const std::string& name) {
  double slowest_ms = 0;
  for (const auto& [process, stages] : summary.stages.items()) {
    for (const Json& stage : stages) {
      if (stage.value("stage", "") != name) continue;
      slowest_ms = std::max(slowest_ms, stage.value("wall_ms", 0.0));
    }
  }
  return slowest_ms / std::max(summary.n_ticks, 1);
}

Json MeanMs(const RunSummary& summary) {
  Json ms = Json::object();
  double sum_ms = 0;
  for (const char* stage : {"render", "detect", "estimate", "control"}) {
    ms[stage] = StageMs(summary, stage);
    sum_ms += ms[stage].get<double>();
  }
  ms["transport"] = std::max(StageMs(summary, "wait") - sum_ms, 0.0);
  return ms;
}

}  // namespace

std::string BuildName() { return fmt::format("{} {}", WINDHOVER_VERSION, kGitHash); }

Json Manifest(const Scenario& scenario, const RunOptions& options, const RunSummary& summary,
              const std::filesystem::path& run_dir) {
  Json manifest = {{"version", WINDHOVER_VERSION},
                   {"git_hash", kGitHash},
                   {"finished", UtcNow()},
                   {"seed", scenario.random_seed},
                   {"observe", WriteValue(scenario.observe)},
                   {"bus", options.in_process    ? "memq"
                           : options.bus.empty() ? "tcpq"
                                                 : options.bus},
                   {"threads", options.threads},
                   {"isa", options.isa},
                   {"record", options.record},
                   {"valid", summary.valid},
                   {"culprit", summary.culprit},
                   {"invalid_reason", summary.reason},
                   {"ticks", summary.n_ticks},
                   {"host", Host()},
                   {"libraries", Libraries()},
                   {"inputs", Inputs(scenario, options.scenario_file)},
                   {"run_lcm_sha256", Sha256OfFile(run_dir / "run.lcm")},
                   {"counters", summary.counters}};
  return manifest;
}

Json Timing(const Scenario& scenario, const RunSummary& summary) {
  const double simulated_s = summary.n_ticks / scenario.frame_rate_hz;
  const auto n_rigs = std::count_if(scenario.aircraft.begin(), scenario.aircraft.end(),
                                    [](const Aircraft& a) { return a.self.carries_rig; });
  const bool is_timed = summary.wall_s > 0;
  Json timing = {
      {"wall_s", summary.wall_s},
      {"simulated_s", simulated_s},
      {"real_time_factor", is_timed ? Json(simulated_s / summary.wall_s) : Json()},
      {"stereo_pairs_per_s",
       is_timed ? Json(static_cast<double>(summary.n_ticks * n_rigs) / summary.wall_s) : Json()},
      {"ms", MeanMs(summary)},
      {"stages", summary.stages},
      {"peak_rss_mib", summary.peak_rss_mib}};
  return timing;
}

}  // namespace windhover
