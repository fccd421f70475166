// Folders may include only what docs/architecture.md's table allows, so that data flows one way:
// scenario -> sim -> render -> estimator -> swarm -> (over the bus) -> sim. Ground truth must not
// reach the code under evaluation, not even through another header.

#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "source_files.h"

namespace windhover::test {
namespace {

namespace fs = std::filesystem;
const fs::path kRoot = WINDHOVER_SOURCE_DIR;

const std::map<std::string, std::set<std::string>> kMayInclude = {
    {"common", {"lcmtypes"}},
    {"camera", {"common"}},
    {"rig", {"common", "camera"}},
    {"scenarios", {"common", "camera", "rig"}},
    {"sim", {"common", "camera", "rig", "scenarios", "lcmtypes"}},
    {"render", {"common", "camera", "rig", "scenarios", "lcmtypes"}},
    {"network", {"common", "lcmtypes"}},
    {"estimator", {"common", "camera", "network", "scenarios", "lcmtypes"}},
    {"swarm", {"common", "scenarios", "lcmtypes"}},
    {"eval", {"common", "camera", "scenarios", "lcmtypes"}},
    {"budget", {"common", "camera", "rig", "scenarios"}},
    {"learn",
     {"common", "camera", "rig", "scenarios", "lcmtypes", "sim", "render", "network", "estimator",
      "eval"}},
    {"dataset", {"common", "camera", "rig", "scenarios", "lcmtypes", "sim", "render", "eval"}},
    {"sweep", {"common", "scenarios", "eval"}},
    {"cli",
     {"common", "scenarios", "network", "eval", "budget", "dataset", "learn", "sweep", "lcmtypes"}},
};

// cli/in_process_run alone may include every node.
const std::set<std::string> kNodes = {"sim", "render", "estimator", "swarm"};

bool IsInProcessRun(const fs::path& file) {
  return file.filename().string().starts_with("in_process_run");
}

// What neither the estimator nor the swarm may see, directly or through other headers.
bool IsTruth(const std::string& header) {
  return header == "common/bus/truth_channels.h" || header == "scenarios/scenario.h" ||
         header.starts_with("rig/");
}

std::vector<std::string> QuotedIncludes(const fs::path& file) {
  static const std::regex kInclude(R"(^\s*#include\s+"([^"]+/[^"]+)\")");
  std::vector<std::string> headers;
  std::smatch match;
  for (const std::string& line : Lines(file)) {
    if (std::regex_search(line, match, kInclude)) headers.push_back(match[1]);
  }
  return headers;
}

// Everything `file` includes, also through other headers of ours.
std::set<std::string> AllIncludes(const fs::path& file) {
  std::set<std::string> seen;
  std::vector<std::string> open = QuotedIncludes(file);
  while (!open.empty()) {
    const std::string header = open.back();
    open.pop_back();
    if (!seen.insert(header).second) continue;
    for (const std::string& next : QuotedIncludes(kRoot / header)) open.push_back(next);
  }
  return seen;
}

TEST(Layering, IncludesFollowTheTable) {
  int includes = 0;
  for (const auto& [folder, allowed] : kMayInclude) {
    for (const fs::path& file : SourceFiles(kRoot / folder)) {
      for (const std::string& header : QuotedIncludes(file)) {
        ++includes;
        const std::string target = header.substr(0, header.find('/'));
        const bool node_of_in_process_run =
            folder == "cli" && IsInProcessRun(file) && kNodes.count(target) > 0;
        EXPECT_TRUE(target == folder || allowed.count(target) > 0 || node_of_in_process_run)
            << file << ": " << folder << "/ may not include " << header;
      }
    }
  }
  EXPECT_GT(includes, 50) << "the scan found almost nothing; is the source path right?";
}

TEST(Layering, EstimatorAndSwarmNeverSeeTheTruth) {
  for (const std::string folder : {"estimator", "swarm"}) {
    const auto files = SourceFiles(kRoot / folder);
    EXPECT_FALSE(files.empty()) << folder;
    for (const fs::path& file : files) {
      for (const std::string& header : AllIncludes(file)) {
        EXPECT_FALSE(IsTruth(header)) << file << " sees " << header;
      }
    }
  }
}

// The scan above must be able to fail: sim does see the truth, through its own headers too.
TEST(Layering, TheScanFindsTruthWhereItIs) {
  bool found = false;
  for (const fs::path& file : SourceFiles(kRoot / "sim")) {
    for (const std::string& header : AllIncludes(file)) found = found || IsTruth(header);
  }
  EXPECT_TRUE(found);
}

TEST(Layering, OnlyTheBusIncludesLcm) {
  static const std::regex kLcm(R"(^\s*#include\s+<lcm/)");
  int users = 0;
  for (const auto& [folder, allowed] : kMayInclude) {
    for (const fs::path& file : SourceFiles(kRoot / folder)) {
      for (const std::string& line : Lines(file)) {
        if (!std::regex_search(line, kLcm)) continue;
        ++users;
        EXPECT_EQ(fs::relative(file, kRoot).parent_path(), "common/bus") << file;
      }
    }
  }
  EXPECT_GT(users, 0);
}

}  // namespace
}  // namespace windhover::test
