#include "sweep/sweep_rules.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "scenarios/rule_findings.h"
#include "sweep/design.h"
#include "sweep/sobol_sequence.h"
#include "sweep/sweep_metric.h"

namespace windhover {
namespace {

bool IsGiven(double number) { return !std::isnan(number); }

std::string Quoted(const std::string& text) { return fmt::format("'{}'", text); }
std::string Quoted(double number) { return fmt::format("'{}'", number); }

class FactorRules {
 public:
  FactorRules(const SweepConfig& config, RuleFindings& findings)
      : config_(config), findings_(findings) {}

  void Check(std::size_t i) {
    const FactorConfig& factor = config_.factors[i];
    path_ = fmt::format("factors.{}", i);
    CheckKey(i);
    const bool is_range = factor.values.empty() && !IsGiven(factor.mean) && !IsGiven(factor.sigma);
    if (!factor.values.empty()) return CheckValues(factor);
    if (is_range) return CheckRange(factor);
    CheckNormal(factor);
  }

 private:
  void CheckKey(std::size_t i) {
    const std::string& key = config_.factors[i].key;
    if (key == "random_seed" || key == "expect" || key.starts_with("expect.")) {
      findings_.MustBe(path_ + ".key", "neither random_seed nor a gate", Quoted(key));
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (config_.factors[j].key != key) continue;
      findings_.MustBe(path_ + ".key", "unlike the key of every other factor",
                       Quoted(key) + " again");
    }
  }

  void CheckValues(const FactorConfig& factor) {
    if (IsGiven(factor.min) || IsGiven(factor.max) || IsGiven(factor.mean) ||
        IsGiven(factor.sigma)) {
      findings_.MustBe(path_, "given values, or a range, or mean and sigma",
                       Quoted(factor.key) + " with more than one of them");
    }
    for (std::size_t k = 1; k < factor.values.size(); ++k) {
      const auto first = factor.values.begin(), self = first + static_cast<std::ptrdiff_t>(k);
      if (std::find(first, self, *self) == self) continue;
      findings_.MustBe(fmt::format("{}.values.{}", path_, k), "given once",
                       Quoted(*self) + " again");
    }
  }

  void CheckRange(const FactorConfig& factor) {
    if (!IsGiven(factor.min) || !IsGiven(factor.max)) {
      return findings_.MustBe(path_, "given values, min and max, or mean and sigma",
                              Quoted(factor.key) + " without them");
    }
    if (factor.min >= factor.max) {
      findings_.MustBe(path_ + ".min", fmt::format("below max, {}", factor.max),
                       Quoted(factor.min));
    }
    CheckLog(factor, "min", factor.min);
  }

  void CheckNormal(const FactorConfig& factor) {
    if (!IsGiven(factor.mean) || !IsGiven(factor.sigma)) {
      return findings_.MustBe(path_, "given both mean and sigma",
                              Quoted(factor.key) + " with one of them");
    }
    if (factor.sigma <= 0) findings_.MustBe(path_ + ".sigma", "above 0", Quoted(factor.sigma));
    if (IsGiven(factor.min) && IsGiven(factor.max) && factor.min >= factor.max) {
      findings_.MustBe(path_ + ".min", fmt::format("below max, {}", factor.max),
                       Quoted(factor.min));
    }
    CheckLog(factor, "mean", factor.mean);
    if (IsGiven(factor.min)) CheckLog(factor, "min", factor.min);
    if (IsGiven(factor.max)) CheckLog(factor, "max", factor.max);
  }

  void CheckLog(const FactorConfig& factor, const char* key, double value) {
    if (factor.scale != FactorScale::kLog || value > 0) return;
    findings_.MustBe(fmt::format("{}.{}", path_, key), "above 0 where scale is log", Quoted(value));
  }

  const SweepConfig& config_;
  RuleFindings& findings_;
  std::string path_;
};

bool IsFactor(const SweepConfig& config, const std::string& key) {
  return std::any_of(config.factors.begin(), config.factors.end(),
                     [&](const FactorConfig& factor) { return factor.key == key; });
}

void CheckDesign(const SweepConfig& config, RuleFindings& findings) {
  std::vector<Factor> factors(config.factors.begin(), config.factors.end());
  if (CountDesignPoints(config.design, factors) > kMaxPoints) {
    findings.MustBe("design", fmt::format("of at most {} points", kMaxPoints), "more", {"factors"});
  }
  constexpr int kMost = SobolSequence::kMaxDimensions;
  if (config.design.type == DesignType::kSobol && factors.size() > kMost) {
    findings.MustBe("factors", fmt::format("at most {} for design sobol", kMost),
                    std::to_string(factors.size()));
  }
}

void CheckStop(const SweepConfig& config, RuleFindings& findings) {
  const StopConfig& stop = config.stop;
  if (stop.metric.empty()) return;
  if (!(stop.width > 0)) {
    findings.MustBe("stop.width", "above 0", IsGiven(stop.width) ? Quoted(stop.width) : "nothing");
  }
  if (stop.min_seeds > config.seeds.count) {
    findings.MustBe("stop.min_seeds", fmt::format("at most seeds.count, {}", config.seeds.count),
                    fmt::format("'{}'", stop.min_seeds));
  }
}

void CheckGates(const SweepConfig& config, RuleFindings& findings) {
  for (std::size_t i = 0; i < config.gates.size(); ++i) {
    const SweepGate& gate = config.gates[i];
    const Expectation& limits = gate.expectation;
    const std::string path = fmt::format("gates.{}", i);
    if (!IsGiven(limits.max) && !IsGiven(limits.min) && !IsGiven(limits.upper95) &&
        !IsGiven(limits.lower95)) {
      findings.MustBe(path, "given max, min, upper95 or lower95", Quoted(limits.metric));
    }
    if (!gate.where.empty() && !IsFactor(config, gate.where)) {
      findings.MustBe(path + ".where", "the key of a factor", Quoted(gate.where));
    }
    if (gate.where.empty() && (IsGiven(gate.from) || IsGiven(gate.to))) {
      findings.MustBe(path + ".where", "the key of a factor, for from and to", "nothing");
    }
  }
}

void CheckAnalysis(const SweepConfig& config, RuleFindings& findings) {
  const AnalysisConfig& analysis = config.analysis;
  for (const auto& [name, key] : {std::pair("x", analysis.x), std::pair("y", analysis.y)}) {
    if (key.empty()) continue;
    const auto at = std::find_if(config.factors.begin(), config.factors.end(),
                                 [&, k = key](const FactorConfig& f) { return f.key == k; });
    if (at == config.factors.end() || !Factor(*at).is_number()) {
      findings.MustBe(fmt::format("analysis.{}", name), "the key of a factor of numbers",
                      Quoted(key));
    }
  }
  if (!analysis.y.empty() && analysis.x == analysis.y) {
    findings.MustBe("analysis.y", "another factor than x", Quoted(analysis.y));
  }
  if (!analysis.pareto.empty() && analysis.pareto.size() != 2) {
    findings.MustBe("analysis.pareto", "two of metrics", fmt::format("{}", analysis.pareto.size()));
  }
}

}  // namespace

void CheckSweepRules(const SweepConfig& config, const ConfigNode& root, Findings& findings) {
  RuleFindings rules(root, InputFiles::kMustExist, findings);
  rules.CheckFile("base", config.base, /*is_needed=*/true, "that factors change", "base");
  FactorRules factors(config, rules);
  for (std::size_t i = 0; i < config.factors.size(); ++i) factors.Check(i);
  if (!findings.Mention("factors")) CheckDesign(config, rules);
  CheckStop(config, rules);
  CheckGates(config, rules);
  CheckAnalysis(config, rules);
}

void CheckSweepMetrics(const SweepConfig& config, const std::vector<std::string>& metrics,
                       const Scenario& base, const ConfigNode& root, Findings& findings) {
  RuleFindings rules(root, InputFiles::kMustExist, findings);
  for (std::size_t i = 0; i < config.metrics.size(); ++i) {
    const std::string problem = WhyNoMetric(base, metrics[i]);
    if (problem.empty()) continue;
    rules.MustBe(fmt::format("metrics.{}", i), "a number of score.json",
                 fmt::format("'{}': {}", metrics[i], problem));
  }
  const auto must_be_listed = [&](const std::string& path, const std::string& metric) {
    if (metric.empty() || std::find(metrics.begin(), metrics.end(), metric) != metrics.end()) {
      return;
    }
    rules.MustBe(path, "one of metrics", Quoted(metric));
  };
  must_be_listed("stop.metric", config.stop.metric);
  must_be_listed("analysis.metric", config.analysis.metric);
  for (std::size_t i = 0; i < config.analysis.pareto.size(); ++i) {
    must_be_listed(fmt::format("analysis.pareto.{}", i), config.analysis.pareto[i]);
  }
  for (std::size_t i = 0; i < config.gates.size(); ++i) {
    must_be_listed(fmt::format("gates.{}.metric", i), config.gates[i].expectation.metric);
  }
}

}  // namespace windhover
