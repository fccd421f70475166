// What the estimators that remember and those that fuse are off by, on the flights of a data set:
// as the rig was when their priors were fitted, and after changes that they were not told of. Also
// the CPU time of an estimate.

#include <cmath>
#include <ctime>
#include <fstream>
#include <iostream>
#include <map>
#include <span>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/random/random_stream.h"
#include "estimator/correction_card.h"
#include "estimator/range_estimator.h"
#include "learn/fit_priors.h"
#include "learn/tuple_source.h"
#include "scenarios/scenario.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

/// A change that estimators are not told of, but for what `told` names: the calibrated rig.
struct Condition {
  std::string name, preset;
  std::vector<std::string> overrides;
  double scale = 1;  ///< Of the target.
};

const std::vector<Condition> kConditions = {
    {"as fitted", "uavde_12mm", {}},
    {"offset -15 px", "uavde_12mm", {"rig.misalignment.offset_px=55"}},
    {"offset +15 px", "uavde_12mm", {"rig.misalignment.offset_px=85"}},
    {"P600",
     "uavde_12mm",
     {"aircraft=[{id: 0, type: p600, carries_rig: true, controller: hold, position_m: [0, 0, 20]}, "
      "{id: 1, type: p600}]"}},
    {"32 % larger", "uavde_12mm", {}, 1.32},
    {"vibration x 2", "uavde_12mm", {"vibration.level=2"}},
    {"20 % missed, hard turns", "uavde_12mm", {"geometric.miss_rate=0.2", "dataset.tilt_deg=20"}},
    {"16 mm", "uavde_16mm", {}},
    {"nominal noise, its priors", "uavde_12mm_nominal", {}},
};

const std::vector<std::string> kMethods = {"offset1", "size", "fusion", "selfcal", "fused"};

struct Arguments {
  int first_seed = 1, n_seeds = 12;
  std::string split = "test";
  fs::path scratch = fs::temp_directory_path();
};

Scenario Base(const std::string& preset, const std::vector<std::string>& changes) {
  std::vector<std::string> overrides = {"observe=geometric", "aircraft=[{id: 0}]",
                                        "description=" + preset};
  overrides.insert(overrides.end(), changes.begin(), changes.end());
  return LoadUndrawnScenario(
      fs::path(WINDHOVER_SOURCE_DIR) / "scenarios/presets" / (preset + ".yaml"), overrides);
}

/// The same frames, with boxes as of a target so much larger.
std::vector<StereoTuple> Scaled(std::vector<StereoTuple> tuples, double scale) {
  for (StereoTuple& tuple : tuples) {
    for (image_box_t* box : {&tuple.box.left, &tuple.box.right}) {
      box->w_px *= scale;
      box->h_px *= scale;
    }
  }
  return tuples;
}

/// Sums over frames; the mean of a data set, then mean and spread over data sets.
struct Score {
  double n = 0, abs_rel = 0, near = 0, n_near = 0, true_abs_rel = 0, nees = 0, covered = 0;
  double cpu_s = 0;
};

class Course {
 public:
  Course(const Scenario& scenario, const FittedPriors& priors, const fs::path& card)
      : config_(scenario.ForAircraft()), lever_m_(priors.lever_m) {
    CorrectionCard content;
    content.priors = priors;
    std::ofstream(card) << CorrectionCardText(content);
    config_.estimator.correction = {card.string(), card.string(), card.string()};
  }

  /// Errors by truth are those of the range; methods with priors report range + lever.
  Score Fly(const std::string& method, std::span<const StereoTuple> tuples) const {
    const bool is_fitted = method == "fusion" || method == "fused";
    Score score;
    std::unique_ptr<RangeEstimator> estimator;
    for (std::size_t i = 0; i < tuples.size(); ++i) {
      const StereoTuple& tuple = tuples[i];
      if (i == 0 || tuple.flight != tuples[i - 1].flight) {
        estimator = MakeRangeEstimator(method, config_);
      }
      StereoObservation observation;
      observation.box = tuple.box;
      observation.utime = tuple.utime;
      const std::clock_t before = std::clock();
      const auto solution = estimator->Estimate(observation);
      score.cpu_s += static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
      if (solution) Add(tuple, *solution, is_fitted ? lever_m_ : 0, &score);
    }
    return score;
  }

 private:
  static void Add(const StereoTuple& tuple, const RangeSolution& solution, double lever_m,
                  Score* score) {
    const double error = std::abs(solution.range_m - tuple.range_m) / tuple.range_m;
    const double true_error_m = solution.range_m - lever_m - tuple.range_true_m;
    const double sigmas = true_error_m / solution.range_sigma_m;
    ++score->n;
    score->abs_rel += error;
    if (tuple.range_m < 20) score->near += error, ++score->n_near;
    score->true_abs_rel += std::abs(true_error_m) / tuple.range_true_m;
    score->nees += sigmas * sigmas;
    score->covered += std::abs(sigmas) <= 1.96;
  }

  AircraftConfig config_;
  double lever_m_;
};

/// How far labels are from range + 0.2 m: no estimator can be nearer to both.
double LabelError(std::span<const StereoTuple> tuples) {
  double sum = 0;
  for (const StereoTuple& tuple : tuples) {
    sum += std::abs(tuple.range_true_m + 0.2 - tuple.range_m) / tuple.range_m;
  }
  return sum / static_cast<double>(tuples.size());
}

void Print(const std::string& condition, const std::string& method, const std::vector<Score>& sets,
           double label_error) {
  Score all;
  double squares = 0;
  for (const Score& set : sets) {
    all.n += set.n, all.n_near += set.n_near, all.near += set.near, all.cpu_s += set.cpu_s;
    all.nees += set.nees, all.covered += set.covered, all.true_abs_rel += set.true_abs_rel;
    all.abs_rel += set.abs_rel / set.n / static_cast<double>(sets.size());
    squares += std::pow(set.abs_rel / set.n, 2) / static_cast<double>(sets.size());
  }
  const auto n = static_cast<double>(sets.size());
  const double sd =
      n > 1 ? std::sqrt(std::max(0.0, squares - all.abs_rel * all.abs_rel) * n / (n - 1)) : 0;
  fmt::print(
      "{:<26} {:<8} {:>7.4f} ±{:.4f} {:>7.4f} {:>9.4f} {:>7.2f} {:>6.1f} % {:>7.4f} {:>6.2f}\n",
      condition, method, all.abs_rel, sd, all.near / all.n_near, all.true_abs_rel / all.n,
      all.nees / all.n, 100 * all.covered / all.n, label_error, 1e6 * all.cpu_s / all.n);
}

void Measure(const Condition& condition, const Arguments& arguments) {
  const bool is_nominal = condition.preset == "uavde_12mm_nominal";
  const Scenario fitted = Base(is_nominal ? condition.preset : "uavde_12mm", {});
  const Scenario flown = Base(condition.preset, condition.overrides);
  const StereoRig fitted_rig = fitted.rig.calibrated.ToStereoRig();
  std::map<std::string, std::vector<Score>> scores;
  double label_error = 0;
  for (int seed = arguments.first_seed; seed < arguments.first_seed + arguments.n_seeds; ++seed) {
    const auto data_seed = static_cast<std::uint64_t>(seed);
    const FittedPriors priors = FitPriors(DrawTuples(fitted, data_seed, 1).train, fitted_rig);
    const TupleSplits splits = DrawTuples(flown, data_seed, 1);
    const auto tuples =
        Scaled(arguments.split == "val" ? splits.val : splits.test, condition.scale);
    label_error += LabelError(tuples) / arguments.n_seeds;
    const Course course(flown, priors, arguments.scratch / "accuracy_bench.json");
    for (const std::string& method : kMethods) {
      scores[method].push_back(course.Fly(method, tuples));
    }
  }
  for (const std::string& method : kMethods) {
    Print(condition.name, method, scores[method], label_error);
  }
}

int Main(int argc, char** argv) {
  CLI::App app{"accuracy of fusion, selfcal and fused"};
  Arguments arguments;
  app.add_option("--first-seed", arguments.first_seed, "first data set")->capture_default_str();
  app.add_option("--seeds", arguments.n_seeds, "data sets")->capture_default_str();
  app.add_option("--split", arguments.split, "what is scored; choose by val, report test")
      ->check(CLI::IsMember({"val", "test"}))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  fmt::print("{:<26} {:<8} {:>7} {:>8} {:>6} {:>9} {:>7} {:>8} {:>7} {:>6}\n", "", "", "Abs Rel",
             "", "< 20 m", "by truth", "NEES", "in 95 %", "labels", "us");
  for (const Condition& condition : kConditions) Measure(condition, arguments);
  return 0;
}

}  // namespace
}  // namespace windhover

int main(int argc, char** argv) { return windhover::Main(argc, argv); }
