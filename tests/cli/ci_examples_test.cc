// The examples for continuous integration: what they run, in their order, with what the services
// put into the environment. Left out: what installs and builds.

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/config/config_tree.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

const fs::path kSource = WINDHOVER_SOURCE_DIR;
const fs::path kBaseline = "baseline/head_on_swarm.json";

bool NeedsNoNetwork(const std::string& line) {
  return line.find("apt-get") == std::string::npos && !line.starts_with("./run ") &&
         !line.starts_with("git config --global");
}

ConfigNode Parsed(const std::string& name) {
  return ParseYaml(TextOf(kSource / "examples/ci" / name), {name, {}});
}

std::vector<std::string> GithubLines() {
  std::vector<std::string> lines;
  const ConfigNode root = Parsed("github-actions.yml");
  for (const ConfigNode& step : NearestNode(root, "jobs.regression.steps").items) {
    if (const ConfigNode* run = step.Find("run")) lines.push_back(run->scalar);
  }
  return lines;
}

std::vector<std::string> GitlabLines() {
  std::vector<std::string> lines;
  const ConfigNode root = Parsed("gitlab-ci.yml");
  for (const ConfigNode& line : NearestNode(root, "regression.script").items) {
    lines.push_back(line.scalar);
  }
  return lines;
}

/// A checkout that is already built.
class CiExamples : public testing::Test {
 protected:
  CiExamples() {
    fs::create_directories(folder_.path() / "build/release");
    fs::create_directory_symlink(WINDHOVER_BIN_DIR, folder_.path() / "build/release/bin");
    for (const char* name : {"examples", "scenarios", "models"}) {
      fs::create_directory_symlink(kSource / name, folder_.path() / name);
    }
  }

  /// Runs lines until one fails. @return its exit status; all that was said is in said_.
  int Run(const std::vector<std::string>& lines) {
    fs::remove_all(folder_.path() / "results");  // As a fresh checkout has none.
    said_.clear();
    const std::string at = folder_.path();
    for (const std::string& line : lines) {
      if (!NeedsNoNetwork(line)) continue;
      Program shell({"/usr/bin/env", "-C", at, "GITHUB_WORKSPACE=" + at,
                     "GITHUB_ENV=" + at + "/env", "CI_PROJECT_DIR=" + at, "CI_COMMIT_BRANCH=main",
                     "CI_DEFAULT_BRANCH=main", "sh", "-e", "-c", line});
      const int status = shell.Wait();
      said_ += shell.Out() + shell.Err();
      if (status != 0) return status;
    }
    return 0;
  }

  /// As if two groups had kept 1 m more distance before.
  void MakeStoredResultBetter() {
    auto score = nlohmann::ordered_json::parse(TextOf(folder_.path() / kBaseline));
    auto& separation_m = score["swarm"]["min_separation_m"];
    separation_m = separation_m.get<double>() + 1;
    folder_.Write(kBaseline, score.dump());
  }

  TemporaryFolder folder_;
  std::string said_;
};

TEST_F(CiExamples, CompareWithWhatMainStored) {
  const std::vector<std::string> github = GithubLines(), gitlab = GitlabLines();
  ASSERT_EQ(github.size(), 6u);
  ASSERT_EQ(gitlab.size(), 4u);
  ASSERT_EQ(Run(github), 0) << said_;
  EXPECT_THAT(said_, HasSubstr("no stored result of main to compare head_on_swarm with"));
  EXPECT_TRUE(fs::exists(folder_.path() / "results/crossing_pair/junit.xml"));
  ASSERT_TRUE(fs::exists(folder_.path() / kBaseline));

  ASSERT_EQ(Run(gitlab), 0) << said_;
  EXPECT_THAT(said_, Not(HasSubstr("no stored result")));

  MakeStoredResultBetter();
  const std::string stored = TextOf(folder_.path() / kBaseline);
  EXPECT_EQ(Run(github), 1) << said_;
  EXPECT_THAT(said_, HasSubstr("swarm.min_separation_m"));
  EXPECT_TRUE(TextOf(folder_.path() / kBaseline) == stored) << "what is worse must not be stored";
}

}  // namespace
}  // namespace windhover
