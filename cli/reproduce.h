#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "learn/lesson.h"

namespace windhover {

/// A result that the paper prints.
struct PublishedScore {
  std::optional<double> abs_rel, sq_rel, near, far;
};

/// One row of a table: a preset with changes, flown as its data set's flights, and the errors of
/// one method over them.
struct ReproducedRow {
  std::string method;  ///< What the table calls it.
  std::string preset;
  std::vector<std::string> overrides = {};  ///< "a.b.c=value"
  std::string estimator = "baseline";       ///< Of estimator.methods.
  Lesson lesson = {};                       ///< Learned behind the 12 mm lenses of uavde_12mm.
  PublishedScore paper_val = {}, paper_test = {};
  std::string why = {};      ///< Where ours and the paper's differ.
  std::string missing = {};  ///< Why there is nothing of ours; empty: there is.
};

struct ReproducedTable {
  std::string name, meaning;
  std::vector<ReproducedRow> rows;
};

/// How much to learn: `--quick` or all.
enum class Effort { kQuick, kFull };

/// The tables of the paper that compare distances.
std::vector<ReproducedTable> ReproducedTables(Effort effort);

struct ReproduceOptions {
  int n_seeds = 12;          ///< Data sets to make; means and spreads are over them.
  int n_training_seeds = 1;  ///< Trainings on each; a row's score is the mean of theirs.
  int threads = 1;
  std::filesystem::path scenarios;  ///< Folder that has presets/.
  CardShelf* cards = nullptr;       ///< Where there are rows with lessons.
  /// Told after each training and each data set; may be empty.
  std::function<void(int done, int total)> on_step = {};
};

/// The preset of a row as the base of its data sets.
/// @throws ConfigError if it cannot be read.
Scenario BaseOf(const ReproducedRow& row, const std::filesystem::path& scenarios);

/// Flies the validation and test flights of each row's data sets (learn/method_trial.h), and
/// scores them as the paper does (eval/metrics.h), on those frames for which every row on the
/// same data has a distance. The answer is the content of NAME.json: {"table", "rows":
/// [{"method", "val": {…}, "test": {…}, "paper": {…}}]}. A mean over data sets comes with its
/// standard deviation over them ("sd") and a 95 % interval that resamples flights ("ci95");
/// "by_distance" is of the test split.
nlohmann::ordered_json Reproduce(const ReproducedTable& table, const ReproduceOptions& options);

/// Parameters, operations and time of what corrects, beside the paper's. Timed on this machine:
/// of all tables only this one differs from run to run.
nlohmann::ordered_json ReproduceResources(const ReproduceOptions& options);

/// A table for a terminal.
std::string ReproducedText(const nlohmann::ordered_json& table);

/// Tables as one page without network: ours beside the paper's with intervals, where and why they
/// differ, errors over distance before and after the corrections.
std::string ReproducedPage(const std::vector<nlohmann::ordered_json>& tables);

}  // namespace windhover
