#include <fstream>
#include <iostream>
#include <thread>

#include <CLI/CLI.hpp>
#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "cli/command.h"
#include "cli/process_run.h"
#include "cli/tool.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

/// One thing that was looked at.
struct Finding {
  std::string name;
  bool ok = false;
  bool needed = true;  ///< For every run; else only for what `name` says.
  std::string found;
  std::string remedy;  ///< A line to type.
};

Finding CheckPackages(const std::string& name, bool needed,
                      const std::vector<std::string>& packages) {
  const std::vector<std::string> missing = MissingPackages(packages);
  const std::string list = fmt::format("{}", fmt::join(missing, " "));
  return {name, missing.empty(), needed, missing.empty() ? "all installed" : "missing: " + list,
          "apt-get install --no-install-recommends " + list};
}

Finding CheckPrograms() {
  std::string missing;
  for (const char* name : {"hub", "sim", "render", "estimator", "swarm"}) {
    const std::string program = std::string("windhover-") + name;
    if (access((ProgramFolder() / program).c_str(), X_OK) != 0) missing += " " + program;
  }
  return {"programs", missing.empty(), true,
          missing.empty() ? ProgramFolder().string() : "missing:" + missing, "./run"};
}

Finding CheckRendering() {
  const int status = RunTool({ProgramFolder() / "windhover-render", "--self-test"}, true);
  return {"OSMesa", status == 0, true,
          status == 0 ? "a context can be made"
                      : fmt::format("windhover-render --self-test ends with {}", status),
          "apt-get install --no-install-recommends libosmesa6"};
}

Finding CheckLoopback() {
  std::ifstream in("/sys/class/net/lo/flags");
  unsigned flags = 0;
  in >> std::hex >> flags;
  constexpr unsigned kUp = 1;
  const bool is_up = (flags & kUp) != 0;
  return {"loopback network", is_up, true, is_up ? "up" : "down", "ip link set lo up"};
}

Finding CheckMulticast() {
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port = htons(7667);
  inet_pton(AF_INET, "239.255.76.67", &group.sin_addr);
  const bool ok = fd >= 0 && connect(fd, reinterpret_cast<sockaddr*>(&group), sizeof group) == 0;
  if (fd >= 0) close(fd);
  return {"multicast route (--bus udpm)", ok, false, ok ? "there is one" : "none",
          "ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo"};
}

Finding CheckMemory() {
  std::ifstream in("/proc/meminfo");
  double available_mib = 0;
  for (std::string key, rest; in >> key && std::getline(in, rest);) {
    if (key == "MemAvailable:") available_mib = std::stod(rest) / 1024;
  }
  // A hub, sim, swarm and estimator of 0.1 GiB each and a render of 0.5 GiB, twice.
  constexpr double kNeeded_mib = 2048;
  return {"memory", available_mib >= kNeeded_mib, true,
          fmt::format("{:.0f} MiB available, {:.0f} needed", available_mib, kNeeded_mib),
          "end other programs, or run with --threads 1"};
}

Finding CheckSharedMemory() {
  struct statvfs info {};
  const bool exists = statvfs("/dev/shm", &info) == 0;
  const double free_mib =
      exists ? static_cast<double>(info.f_bavail) * static_cast<double>(info.f_frsize) / (1 << 20)
             : 0;
  constexpr double kWanted_mib = 64;
  return {"/dev/shm", free_mib >= kWanted_mib, false, fmt::format("{:.0f} MiB free", free_mib),
          "mount -o remount,size=256M /dev/shm"};
}

Finding CheckSpy() {
  std::string missing;
  for (const char* tool : {"java", "javac", "lcm-gen"}) {
    if (FindTool(tool).empty()) missing += std::string(" ") + tool;
  }
  for (const char* jar : {"/usr/share/java/lcm.jar", "/usr/share/java/jchart2d.jar"}) {
    if (access(jar, R_OK) != 0) missing += std::string(" ") + jar;
  }
  return {"windhover spy", missing.empty(), false,
          missing.empty() ? "can be built" : "missing:" + missing,
          "apt-get install default-jdk liblcm-bin liblcm-java libjchart2d-java"};
}

std::vector<Finding> Examine() {
  std::vector<Finding> findings;
  findings.push_back(CheckPrograms());
  findings.push_back(CheckPackages("packages", true,
                                   {"liblcm1", "libopencv-imgcodecs406", "libosmesa6", "libassimp5",
                                    "libyaml-cpp0.7", "libfmt9"}));
  findings.push_back(CheckPackages("trained detectors", false,
                                   {"libdnnl2", "libonnx1", "libprotobuf32", "libopencv-dnn406"}));
  findings.push_back(CheckPackages("training of detectors", false, {"libtorch1.13"}));
  findings.push_back(CheckRendering());
  findings.push_back(CheckLoopback());
  findings.push_back(CheckMemory());
  findings.push_back(CheckMulticast());
  findings.push_back(CheckSharedMemory());
  findings.push_back(CheckSpy());
  return findings;
}

void PrintTable(const std::vector<Finding>& findings) {
  for (const Finding& finding : findings) {
    const char* state = finding.ok ? "ok" : finding.needed ? "MISSING" : "missing";
    fmt::print("{:<8} {:<30} {}\n", state, finding.name, finding.found);
    if (!finding.ok) fmt::print("{:<8} {:<30}   {}\n", "", "", finding.remedy);
  }
}

void PrintJson(const std::vector<Finding>& findings) {
  Json list = Json::array();
  for (const Finding& finding : findings) {
    list.push_back({{"name", finding.name},
                    {"ok", finding.ok},
                    {"needed", finding.needed},
                    {"found", finding.found},
                    {"remedy", finding.ok ? "" : finding.remedy}});
  }
  std::cout << Json{{"checks", list}, {"cpu_threads", std::thread::hardware_concurrency()}}.dump(2)
            << '\n';
}

int Doctor(bool as_json) {
  const std::vector<Finding> findings = Examine();
  as_json ? PrintJson(findings) : PrintTable(findings);
  for (const Finding& finding : findings) {
    if (finding.needed && !finding.ok) return kEnvironmentMissing;
  }
  return kPass;
}

}  // namespace

void AddDoctorCommand(CLI::App& app, CommandAction* chosen) {
  auto as_json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand(
      "doctor", "what is missing or too small on this machine, with the line that mends it");
  command->add_flag("--json", *as_json, "print JSON instead of a table");
  command->footer("Example: windhover doctor");
  command->callback([=] { *chosen = [=] { return Doctor(*as_json); }; });
}

}  // namespace windhover
