#include "cli/reproduce.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "cli/reproduce_tally.h"
#include "learn/method_trial.h"
#include "scenarios/dataset.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

constexpr Split kScored[] = {Split::kVal, Split::kTest};
constexpr const char* kScoredNames[] = {"val", "test"};

Json Published(const PublishedScore& paper) {
  Json json = Json::object();
  const auto add = [&](const char* key, const std::optional<double>& value) {
    if (value) json[key] = *value;
  };
  add("abs_rel", paper.abs_rel);
  add("sq_rel", paper.sq_rel);
  add("lt20", paper.near);
  add("gt20", paper.far);
  return json;
}

/// Rows that are flown on the same data, and how they did on each flight of a split.
struct Trial {
  std::vector<std::size_t> rows;                           ///< Of the table.
  std::array<std::vector<std::vector<Tally>>, 2> flights;  ///< [split][row][flight]
};

std::vector<Trial> TrialsOf(const ReproducedTable& table) {
  std::vector<Trial> trials;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const ReproducedRow& row = table.rows[i];
    if (!row.missing.empty()) continue;
    auto trial = std::find_if(trials.begin(), trials.end(), [&](const Trial& other) {
      const ReproducedRow& first = table.rows[other.rows.front()];
      return first.preset == row.preset && first.overrides == row.overrides;
    });
    if (trial == trials.end()) trial = trials.insert(trial, Trial{});
    trial->rows.push_back(i);
    for (auto& split : trial->flights) split.emplace_back();
  }
  return trials;
}

/// Each row's method, once for each training; `row_of` says whose.
std::vector<TrialMethod> MethodsOf(const ReproducedTable& table, const Trial& trial,
                                   std::uint64_t data_seed, const ReproduceOptions& options,
                                   std::vector<std::size_t>* row_of) {
  std::vector<TrialMethod> methods;
  for (std::size_t r = 0; r < trial.rows.size(); ++r) {
    const ReproducedRow& row = table.rows[trial.rows[r]];
    const bool learns = !row.lesson.name.empty();
    for (int seed = 1; seed <= (learns ? options.n_training_seeds : 1); ++seed) {
      const auto training_seed = static_cast<std::uint64_t>(seed);
      methods.push_back({row.estimator, ""});
      if (learns) {
        methods.back().card = options.cards->FileOf({row.lesson, data_seed, training_seed});
      }
      row_of->push_back(r);
    }
  }
  return methods;
}

void TryOn(const ReproducedTable& table, std::uint64_t data_seed, const ReproduceOptions& options,
           Trial* trial) {
  const Scenario base = BaseOf(table.rows[trial->rows.front()], options.scenarios);
  std::vector<std::size_t> row_of;
  const auto methods = MethodsOf(table, *trial, data_seed, options, &row_of);
  for (std::size_t split = 0; split < std::size(kScored); ++split) {
    std::vector<Scenario> flights;
    for (int i = 0; i < base.dataset.Of(kScored[split]).flights; ++i) {
      flights.push_back(DatasetFlight(base, kScored[split], i, data_seed));
    }
    for (const auto& frames : TryMethods(flights, methods, options.threads)) {
      std::vector<Tally> tallies = TalliesOf(frames, row_of, trial->rows.size());
      for (std::size_t r = 0; r < tallies.size(); ++r) {
        trial->flights[split][r].push_back(std::move(tallies[r]));
      }
    }
  }
}

std::vector<CardShelf::Request> CardsFor(const ReproducedTable& table,
                                         const ReproduceOptions& options) {
  std::vector<CardShelf::Request> cards;
  for (const ReproducedRow& row : table.rows) {
    if (row.lesson.name.empty() || !row.missing.empty()) continue;
    for (int data = 1; data <= options.n_seeds; ++data) {
      for (int training = 1; training <= options.n_training_seeds; ++training) {
        cards.push_back(
            {row.lesson, static_cast<std::uint64_t>(data), static_cast<std::uint64_t>(training)});
      }
    }
  }
  return cards;
}

Json RowJson(const ReproducedRow& row) {
  Json json = {{"method", row.method}, {"preset", row.preset}, {"set", row.overrides}};
  json["estimator"] = row.estimator;
  if (!row.lesson.name.empty()) json["learned"] = row.lesson.name;
  if (!row.missing.empty()) json["missing"] = row.missing;
  if (!row.why.empty()) json["why"] = row.why;
  return json;
}

}  // namespace

Scenario BaseOf(const ReproducedRow& row, const std::filesystem::path& scenarios) {
  // A preset has no aircraft; a data set brings its own.
  std::vector<std::string> overrides = {"observe=geometric", "aircraft=[{id: 0}]",
                                        "description=" + row.preset};
  overrides.insert(overrides.end(), row.overrides.begin(), row.overrides.end());
  return LoadUndrawnScenario(scenarios / "presets" / (row.preset + ".yaml"), overrides);
}

Json Reproduce(const ReproducedTable& table, const ReproduceOptions& options) {
  std::vector<Trial> trials = TrialsOf(table);
  const auto cards = CardsFor(table, options);
  const int total =
      static_cast<int>(cards.size()) + options.n_seeds * static_cast<int>(trials.size());
  int done = 0;
  const auto step = [&] {
    if (options.on_step) options.on_step(++done, total);
  };
  if (!cards.empty()) options.cards->Fetch(cards, step);
  done = static_cast<int>(cards.size());  // Of which some were there.
  for (Trial& trial : trials) {
    for (int seed = 1; seed <= options.n_seeds; ++seed) {
      TryOn(table, static_cast<std::uint64_t>(seed), options, &trial);
      step();
    }
  }
  std::vector<Json> rows;
  for (const ReproducedRow& row : table.rows) rows.push_back(RowJson(row));
  for (const Trial& trial : trials) {
    for (std::size_t r = 0; r < trial.rows.size(); ++r) {
      Json& json = rows[trial.rows[r]];
      for (std::size_t split = 0; split < std::size(kScored); ++split) {
        json[kScoredNames[split]] = ScoreOf(trial.flights[split][r], options.n_seeds);
      }
      json["by_distance"] = ByDistance(trial.flights[1][r]);
    }
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i]["paper"] = {{"val", Published(table.rows[i].paper_val)},
                        {"test", Published(table.rows[i].paper_test)}};
  }
  return {{"table", table.name}, {"meaning", table.meaning}, {"rows", rows}};
}

}  // namespace windhover
