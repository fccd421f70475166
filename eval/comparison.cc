#include "eval/comparison.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "common/config/config_tree.h"
#include "eval/bootstrap.h"
#include "eval/score_metric.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kBootstrapSeed = 1;

/// Paths of the numbers below `json`, without intervals and lists.
void ListNumbers(const Json& json, const std::string& path, std::vector<std::string>* paths) {
  for (const auto& [key, value] : json.items()) {
    if (key == "ci95") continue;
    const std::string own = path + "." + key;
    if (value.is_object()) ListNumbers(value, own, paths);
    if (value.is_number()) paths->push_back(own);
  }
}

std::vector<std::string> MetricsOf(std::span<const Json> scores) {
  std::vector<std::string> paths;
  for (const Json& score : scores) {
    for (const char* section : {"methods", "swarm"}) {
      if (!score.contains(section)) continue;
      std::vector<std::string> own;
      ListNumbers(score[section], section, &own);
      for (std::string& path : own) {
        if (std::find(paths.begin(), paths.end(), path) == paths.end()) {
          paths.push_back(std::move(path));
        }
      }
    }
  }
  return paths;
}

std::optional<double> MetricIn(const Json& score, const std::string& path) {
  const FoundMetric found = FindMetric(score, path);
  return found.value == nullptr ? std::nullopt : NumberIn(*found.value);
}

/// What identifies a frame of a target in both runs.
using FrameKey = std::tuple<Utime, int, int>;

/// |d - d*| / d* of the frames in which a method has an estimate.
std::map<FrameKey, double> RelativeErrors(const Evaluation& run, const std::string& method) {
  const auto& methods = run.run.scenario.estimator.methods;
  const auto at = std::find(methods.begin(), methods.end(), method);
  std::map<FrameKey, double> errors;
  if (at == methods.end()) return errors;
  const auto index = static_cast<std::size_t>(at - methods.begin());
  for (const TargetFrame& frame : run.targets.frames) {
    const auto& estimate = frame.estimates.at(index);
    if (!estimate) continue;
    errors[{frame.utime, frame.observer_id, frame.truth.target_id}] =
        std::abs(estimate->range_m - frame.reference_m) / frame.reference_m;
  }
  return errors;
}

std::optional<MetricDifference> CompareMethod(const Evaluation& a, const Evaluation& b,
                                              const std::string& method) {
  const auto in_a = RelativeErrors(a, method), in_b = RelativeErrors(b, method);
  MetricDifference difference{.metric = "methods." + method + ".abs_rel", .ci95 = {}};
  std::vector<std::pair<Utime, double>> differences;
  for (const auto& [key, error] : in_a) {
    const auto other = in_b.find(key);
    if (other == in_b.end()) continue;
    difference.a += error;
    difference.b += other->second;
    differences.emplace_back(std::get<0>(key), other->second - error);
  }
  if (differences.empty()) return std::nullopt;
  difference.n = static_cast<int>(differences.size());
  difference.a /= difference.n;
  difference.b /= difference.n;
  const TimeBlocks blocks(differences.front().first, differences.back().first,
                          1 / a.run.scenario.frame_rate_hz, kMinBlock_s);
  std::vector<BlockSum> sums(static_cast<std::size_t>(blocks.count()));
  for (const auto& [utime, value] : differences) {
    BlockSum& block = sums[static_cast<std::size_t>(blocks.BlockOf(utime))];
    block.sum += value;
    ++block.count;
  }
  difference.ci95 = BootstrapInterval95(sums, kBootstrapSeed);
  return difference;
}

void ListValues(const ConfigNode& node, const std::string& path,
                std::vector<std::pair<std::string, std::string>>* values) {
  if (node.IsScalar()) values->emplace_back(path, node.scalar);
  const std::string before = path.empty() ? "" : path + ".";
  for (const auto& entry : node.entries) ListValues(entry.value, before + entry.key, values);
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    ListValues(node.items[i], before + std::to_string(i), values);
  }
}

std::vector<std::pair<std::string, std::string>> ValuesOf(const Scenario& scenario) {
  std::vector<std::pair<std::string, std::string>> values;
  ListValues(ParseYaml(ResolvedYaml(scenario, PathStyle::kAsGiven), {"resolved", {}}), "", &values);
  return values;
}

Regression FindRegression(const Json& baseline, const Json& score, const AllowedLoss& allowed) {
  Regression regression{
      .allowed = allowed, .before = {}, .now = {}, .loss = 0, .pass = false, .message = {}};
  for (const bool is_now : {false, true}) {
    const FoundMetric found = FindMetric(is_now ? score : baseline, allowed.metric);
    auto& value = is_now ? regression.now : regression.before;
    if (found.value != nullptr) value = NumberIn(*found.value);
    if (value || !regression.message.empty()) continue;
    regression.message =
        fmt::format("{}: {}", is_now ? "the run" : "the baseline",
                    found.problem.empty() ? "the metric has no value" : found.problem);
  }
  if (!regression.message.empty()) return regression;
  const double more = *regression.now - *regression.before;
  // A bias is as bad to either side.
  const bool is_signed = allowed.metric.ends_with("bias_m");
  regression.loss = is_signed ? std::abs(*regression.now) - std::abs(*regression.before)
                    : MoreIsBetter(allowed.metric) ? -more
                                                   : more;
  regression.pass = regression.loss <= allowed.most;
  if (!regression.pass) {
    regression.message =
        fmt::format("worse by {:.6g}, allowed are {:.6g}", regression.loss, allowed.most);
  }
  return regression;
}

}  // namespace

std::vector<MetricDifference> CompareScores(std::span<const Json> a, std::span<const Json> b) {
  std::vector<MetricDifference> differences;
  for (const std::string& path : MetricsOf(a)) {
    MetricDifference difference{.metric = path, .ci95 = {}};
    std::vector<BlockSum> pairs;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
      const auto in_a = MetricIn(a[i], path), in_b = MetricIn(b[i], path);
      if (!in_a || !in_b) continue;
      difference.a += *in_a;
      difference.b += *in_b;
      pairs.push_back({*in_b - *in_a, 1});
    }
    if (pairs.empty()) continue;
    difference.n = static_cast<int>(pairs.size());
    difference.a /= difference.n;
    difference.b /= difference.n;
    difference.ci95 = BootstrapInterval95(pairs, kBootstrapSeed);
    differences.push_back(std::move(difference));
  }
  return differences;
}

std::vector<MetricDifference> CompareFrames(const Evaluation& a, const Evaluation& b) {
  std::vector<MetricDifference> differences;
  for (const MethodScore& method : a.methods) {
    auto difference = CompareMethod(a, b, method.method);
    if (difference) differences.push_back(std::move(*difference));
  }
  return differences;
}

std::vector<std::string> DifferentKeys(const Scenario& a, const Scenario& b) {
  const auto in_a = ValuesOf(a), in_b = ValuesOf(b);
  const std::map<std::string, std::string> from_a(in_a.begin(), in_a.end());
  const std::map<std::string, std::string> from_b(in_b.begin(), in_b.end());
  std::vector<std::string> lines;
  for (const auto& [key, value] : in_a) {
    const auto other = from_b.find(key);
    const std::string of_b = other == from_b.end() ? "none" : other->second;
    if (of_b != value) lines.push_back(fmt::format("{}: {} → {}", key, value, of_b));
  }
  for (const auto& [key, value] : in_b) {
    if (from_a.count(key) == 0) lines.push_back(fmt::format("{}: none → {}", key, value));
  }
  return lines;
}

std::vector<Regression> FindRegressions(const Json& baseline, const Json& score,
                                        std::span<const AllowedLoss> allowed) {
  std::vector<Regression> regressions;
  for (const AllowedLoss& one : allowed) {
    regressions.push_back(FindRegression(baseline, score, one));
  }
  return regressions;
}

}  // namespace windhover
