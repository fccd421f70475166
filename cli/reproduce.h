#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

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
  std::vector<std::string> overrides;  ///< "a.b.c=value"
  std::string estimator = "baseline";  ///< Of estimator.methods.
  PublishedScore paper_val, paper_test;
};

struct ReproducedTable {
  std::string name, meaning;
  std::vector<ReproducedRow> rows;
};

/// The tables that can be made.
const std::vector<ReproducedTable>& ReproducedTables();

struct ReproduceOptions {
  int n_seeds = 12;                 ///< Data sets to make; means and spreads are over them.
  std::filesystem::path scratch;    ///< Folder for the log of the flight in the air.
  std::filesystem::path scenarios;  ///< Folder that has presets/.
  /// Told after each flight; may be empty.
  std::function<void(int done, int total)> on_flight;
};

/// Flies the validation and test flights of each row's data sets through the whole geometric
/// loop in this process, and scores them as the paper does (eval/metrics.h). The answer is the
/// content of NAME.json: {"table", "rows": [{"method", "val": {…}, "test": {…}, "paper": {…}}]}.
/// A mean over data sets comes with its standard deviation over them ("sd") and a 95 % interval
/// that resamples flights ("ci95").
nlohmann::ordered_json Reproduce(const ReproducedTable& table, const ReproduceOptions& options);

/// The same as a table for a terminal.
std::string ReproducedText(const nlohmann::ordered_json& table);

}  // namespace windhover
