#include "scenarios/randomize.h"

#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "common/config/config_reader.h"
#include "common/random/random_stream.h"
#include "scenarios/scenario_rules.h"

namespace windhover {
namespace {

/// A value to read into a key, and where to say that it is wrong.
struct Candidate {
  std::string text;
  SourceLocation where;
};

// "a.b: text" as the tree of a file that has nothing else.
ConfigNode TreeOf(const std::string& key, const SourceLocation& key_where,
                  const Candidate& candidate) {
  ConfigNode node;
  node.kind = ConfigNode::Kind::kScalar;
  node.scalar = candidate.text;
  node.where = candidate.where;
  const std::vector<std::string> parts = SplitPath(key);
  for (auto part = parts.rbegin(); part != parts.rend(); ++part) {
    ConfigNode map;
    map.kind = ConfigNode::Kind::kMap;
    map.where = key_where;
    map.entries.push_back({*part, key_where, std::move(node)});
    node = std::move(map);
  }
  return node;
}

std::string DrawnText(const RandomizedKey& randomized, std::uint64_t seed) {
  RandomStream random(seed, "randomize/" + randomized.key);
  if (randomized.one_of.empty()) {
    return WriteValue(random.Uniform(randomized.min, randomized.max));
  }
  const auto n = static_cast<double>(randomized.one_of.size());
  return randomized.one_of[static_cast<std::size_t>(n * random.Uniform())];
}

class Checker {
 public:
  Checker(const Scenario& scenario, const ConfigNode& root, Findings& findings)
      : scenario_(scenario), root_(root), findings_(findings) {}

  void Check(std::size_t i) {
    const RandomizedKey& randomized = scenario_.randomize[i];
    const std::string path = fmt::format("randomize.{}", i);
    if (findings_.Mention(path)) return;
    if (!IsBounded(randomized)) {
      return MustBe(path, "given min and max, or one_of", fmt::format("'{}'", randomized.key));
    }
    if (randomized.min > randomized.max) {
      return MustBe(path + ".min", fmt::format("at most max, {}", randomized.max),
                    fmt::format("'{}'", randomized.min));
    }
    const std::string key_path = path + ".key", found = fmt::format("'{}'", randomized.key);
    if (randomized.key == "random_seed" || randomized.key.ends_with("file")) {
      return MustBe(key_path, "neither random_seed nor a file", found);
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (scenario_.randomize[j].key == randomized.key) {
        return MustBe(key_path, "unlike every other key that is drawn", found + " again");
      }
    }
    for (const Candidate& candidate : CandidatesOf(randomized, path)) {
      const ConfigNode tree = TreeOf(randomized.key, WhereIs(key_path), candidate);
      Scenario read = scenario_;
      Findings wrong;
      ReadConfig(tree, read, wrong);
      if (wrong.empty()) continue;
      return ReadConfig(tree, read, findings_);  // Says it once.
    }
  }

 private:
  static bool IsBounded(const RandomizedKey& randomized) {
    const int bounds = !std::isnan(randomized.min) + !std::isnan(randomized.max);
    return bounds == (randomized.one_of.empty() ? 2 : 0);
  }

  SourceLocation WhereIs(const std::string& path) const { return NearestNode(root_, path).where; }

  void MustBe(const std::string& path, const std::string& must, const std::string& found) {
    findings_.MustBe(WhereIs(path), path, must, found);
  }

  // Limits are intervals: what the ends may be, and something between them, may be all.
  std::vector<Candidate> CandidatesOf(const RandomizedKey& randomized,
                                      const std::string& path) const {
    std::vector<Candidate> candidates;
    for (std::size_t k = 0; k < randomized.one_of.size(); ++k) {
      candidates.push_back({randomized.one_of[k], WhereIs(fmt::format("{}.one_of.{}", path, k))});
    }
    if (!candidates.empty()) return candidates;
    const double between = randomized.min + (randomized.max - randomized.min) / std::sqrt(7);
    return {{WriteValue(randomized.min), WhereIs(path + ".min")},
            {WriteValue(randomized.max), WhereIs(path + ".max")},
            {WriteValue(between), WhereIs(path + ".key")}};
  }

  const Scenario& scenario_;
  const ConfigNode& root_;
  Findings& findings_;
};

}  // namespace

Scenario Drawn(Scenario scenario) {
  if (scenario.randomize.empty()) return scenario;
  // What is drawn was checked where it was written; what only some draws break has no other place.
  ConfigNode nowhere;
  nowhere.kind = ConfigNode::Kind::kMap;
  nowhere.where.source = std::make_shared<const ConfigSource>(
      ConfigSource{fmt::format("randomize, random_seed {}", scenario.random_seed), {}});
  Findings findings;
  for (const RandomizedKey& randomized : scenario.randomize) {
    const std::string text = DrawnText(randomized, scenario.random_seed);
    ReadConfig(TreeOf(randomized.key, nowhere.where, {text, nowhere.where}), scenario, findings);
  }
  CheckRules(scenario, nowhere, InputFiles::kNotNeeded, findings);
  findings.ThrowIfAny();
  scenario.randomize.clear();
  return scenario;
}

void CheckRandomized(const Scenario& scenario, const ConfigNode& root, Findings& findings) {
  Checker checker(scenario, root, findings);
  for (std::size_t i = 0; i < scenario.randomize.size(); ++i) checker.Check(i);
}

}  // namespace windhover
