#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/config/fields.h"
#include "scenarios/scenario.h"

namespace windhover {

enum class FactorScale { kLinear, kLog };
template <>
inline constexpr EnumNames<FactorScale> kEnumNames<FactorScale>{{FactorScale::kLinear, "linear"},
                                                                {FactorScale::kLog, "log"}};

/// One key of the scenario that differs from point to point: a list of values, a range, or a normal
/// distribution.
struct FactorConfig {
  std::string key = {};
  std::vector<std::string> values = {};
  double min = kUnset, max = kUnset;
  double mean = kUnset, sigma = kUnset;
  FactorScale scale = FactorScale::kLinear;
  int levels = 5;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("key", key, NotEmpty{}, "key of the scenario: vibration.level, aircraft.1.yaw_deg");
    v.Field("values", values, MayBeEmpty{}, "numbers or words, each as likely");
    v.Field("min", min, Optional{}, "smallest value");
    v.Field("max", max, Optional{}, "largest value");
    v.Field("mean", mean, Optional{}, "of a normal distribution, of the median where scale is log");
    v.Field("sigma", sigma, Optional{},
            "its standard deviation, of the natural logarithm where scale is log");
    v.Field("scale", scale, AnyEnum{}, "how values lie between min and max");
    v.Field("levels", levels, InRange{2, 1000}, "grid, one_at_a_time: values of a range");
  }
};

enum class DesignType { kGrid, kLatinHypercube, kSobol, kOneAtATime };
template <>
inline constexpr EnumNames<DesignType> kEnumNames<DesignType>{
    {DesignType::kGrid, "grid"},
    {DesignType::kLatinHypercube, "latin_hypercube"},
    {DesignType::kSobol, "sobol"},
    {DesignType::kOneAtATime, "one_at_a_time"}};

inline constexpr int kMaxPoints = 10000;

/// Which combinations of the factors' values are flown.
struct DesignConfig {
  DesignType type = DesignType::kGrid;
  int points = 64;
  std::uint64_t seed = 1;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("type", type, AnyEnum{}, "how points are chosen");
    v.Field("points", points, InRange{1, kMaxPoints}, "latin_hypercube, sobol: how many");
    v.Field("seed", seed, InRange{0, 9e15}, "latin_hypercube: of its draws");
  }
};

/// random_seed of a point's runs: the same at every point (common random numbers).
struct SeedsConfig {
  std::uint64_t first = 1;
  int count = 10;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("first", first, InRange{0, 9e14}, "of the first run");
    v.Field("count", count, InRange{1, 1000000}, "runs of a point, at most if there is a stop");
  }
};

/// A point needs no more runs when the 95 % interval of a metric's mean is narrow enough.
struct StopConfig {
  std::string metric = {};
  double width = kUnset;
  int min_seeds = 5;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("metric", metric, MayBeEmpty{}, "one of metrics; empty: every point has all its runs");
    v.Field("width", width, Optional{}, "of its 95 % interval, at which a point is done");
    v.Field("min_seeds", min_seeds, InRange{2, 1000000}, "runs before that");
  }
};

/// A limit on a metric's mean at every point, or at those at which a factor is within bounds.
struct SweepGate {
  Expectation expectation = {};
  std::string where = {};
  double from = kUnset, to = kUnset;

  template <typename Visitor>
  void Fields(Visitor& v) {
    expectation.Fields(v);
    v.Field("where", where, MayBeEmpty{}, "key of a factor; empty: every point");
    v.Field("from", from, Optional{}, "smallest value of that factor");
    v.Field("to", to, Optional{}, "largest value of that factor");
  }
};

/// What the analysis looks at.
struct AnalysisConfig {
  std::string metric = {};
  double limit = kUnset;
  std::string x = {}, y = {};
  std::vector<std::string> pareto = {};

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("metric", metric, MayBeEmpty{}, "the response, one of metrics; empty: the first");
    v.Field("limit", limit, Optional{}, "value of it whose contour is drawn");
    v.Field("x", x, MayBeEmpty{}, "key of the map's first factor; empty: the first with numbers");
    v.Field("y", y, MayBeEmpty{}, "key of its second");
    v.Field("pareto", pareto, MayBeEmpty{}, "two of metrics, to be traded against each other");
  }
};

/// sweep.yaml, less its section `set`: changes to the base scenario, written as a scenario is.
struct SweepConfig {
  std::string description;
  InputFile base;
  std::vector<FactorConfig> factors;
  DesignConfig design;
  SeedsConfig seeds;
  StopConfig stop;
  std::vector<std::string> metrics;
  std::vector<SweepGate> gates;
  int retries = 1;
  int keep = 20;
  bool retrain = false;
  AnalysisConfig analysis;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("description", description, NotEmpty{}, "one sentence: what this sweep asks");
    v.Field("base", base, NotEmpty{}, "scenario file; `set` changes it, factors change that");
    v.List("factors", factors, "keys that differ from point to point");
    v.Section("design", design, "which combinations of their values are flown");
    v.Section("seeds", seeds, "runs of a point");
    v.Section("stop", stop, "when a point needs no more runs");
    v.Field("metrics", metrics, MayBeEmpty{},
            "paths in score.json that the table has; empty: the usual ones of every method");
    v.List("gates", gates, "the sweep passes when all hold");
    v.Field("retries", retries, InRange{0, 10}, "how often an invalid run is tried again");
    v.Field("keep", keep, InRange{0, 100000}, "folders of runs that do not pass, at most");
    v.Field("retrain", retrain, AnyBool{},
            "train what methods learn on the rig of each point; estimator.correction is not used");
    v.Section("analysis", analysis, "what the report looks at");
  }
};

}  // namespace windhover
