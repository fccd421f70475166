#include "cli/reproduce.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "cli/in_process_run.h"
#include "eval/bootstrap.h"
#include "eval/metrics.h"
#include "eval/run_log_record.h"
#include "eval/samples.h"
#include "scenarios/dataset.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

/// Sums over frames with an estimate; a share or mean is its sum by its count.
struct Tally {
  BlockSum abs_rel, sq_rel, near, far, under, detected;

  void Add(double reference_m, const std::optional<MethodEstimate>& estimate) {
    ++detected.count;
    if (!estimate) return;
    ++detected.sum;
    const double error_m = estimate->range_m - reference_m;
    const auto add = [](BlockSum* to, double term) {
      to->sum += term;
      ++to->count;
    };
    add(&abs_rel, std::abs(error_m) / reference_m);
    add(&sq_rel, error_m * error_m / reference_m);
    add(reference_m < kNearFar_m ? &near : &far, std::abs(error_m) / reference_m);
    add(&under, error_m < 0 ? 1 : 0);
  }
};

struct Quantity {
  const char* key;
  BlockSum Tally::*sum;
};
constexpr Quantity kQuantities[] = {{"abs_rel", &Tally::abs_rel},
                                    {"sq_rel", &Tally::sq_rel},
                                    {"lt20", &Tally::near},
                                    {"gt20", &Tally::far},
                                    {"under_estimated", &Tally::under},
                                    {"detected", &Tally::detected}};

Tally FlyAndScore(const Scenario& scenario, std::size_t method, const ReproduceOptions& options) {
  RunOptions run;
  run.quiet = true;
  const RunSummary summary = RunInOneProcess(scenario, options.scratch, run);
  if (summary.interrupted) throw std::runtime_error("interrupted");
  if (!summary.valid) throw std::runtime_error(summary.culprit + ": " + summary.reason);
  const TargetFrames targets = CollectTargetFrames(ReadRunRecord(options.scratch / "run.lcm"));
  Tally tally;
  for (const TargetFrame& frame : targets.frames) {
    tally.Add(frame.reference_m, frame.estimates[method]);
  }
  return tally;
}

/// Mean of `quantity` over data sets of equally many flights each, with its spread and interval.
void AddQuantity(const Quantity& quantity, const std::vector<Tally>& flights, int n_seeds,
                 Json* score) {
  const std::size_t per_set = flights.size() / static_cast<std::size_t>(n_seeds);
  std::vector<BlockSum> blocks;
  double sum = 0, squares = 0;
  for (std::size_t begin = 0; begin < flights.size(); begin += per_set) {
    BlockSum set;
    for (std::size_t i = begin; i < begin + per_set; ++i) {
      const BlockSum& flight = flights[i].*quantity.sum;
      blocks.push_back(flight);
      set.sum += flight.sum;
      set.count += flight.count;
    }
    const double mean = set.count > 0 ? set.sum / set.count : 0;
    sum += mean;
    squares += mean * mean;
  }
  const double mean = sum / n_seeds;
  (*score)[quantity.key] = mean;
  if (n_seeds > 1) {
    const double variance = (squares - n_seeds * mean * mean) / (n_seeds - 1);
    (*score)["sd"][quantity.key] = std::sqrt(std::max(0.0, variance));
  }
  if (const auto interval = BootstrapInterval95(blocks, 1)) {
    (*score)["ci95"][quantity.key] = *interval;
  }
}

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

std::size_t PositionOf(const std::string& method, const Scenario& scenario) {
  const auto& methods = scenario.estimator.methods;
  for (std::size_t i = 0; i < methods.size(); ++i) {
    if (methods[i] == method) return i;
  }
  throw std::invalid_argument("the preset does not run the method " + method);
}

Scenario BaseOf(const ReproducedRow& row, const std::filesystem::path& scenarios) {
  // A preset has no aircraft; a data set brings its own.
  std::vector<std::string> overrides = {"observe=geometric", "aircraft=[{id: 0}]",
                                        "description=" + row.preset};
  overrides.insert(overrides.end(), row.overrides.begin(), row.overrides.end());
  return LoadUndrawnScenario(scenarios / "presets" / (row.preset + ".yaml"), overrides);
}

constexpr Split kScored[] = {Split::kVal, Split::kTest};
constexpr const char* kScoredNames[] = {"val", "test"};

int FlightsOf(const ReproducedTable& table, const ReproduceOptions& options) {
  int n = 0;
  for (const ReproducedRow& row : table.rows) {
    const DatasetConfig dataset = BaseOf(row, options.scenarios).dataset;
    for (const Split split : kScored) n += options.n_seeds * dataset.Of(split).flights;
  }
  return n;
}

}  // namespace

Json Reproduce(const ReproducedTable& table, const ReproduceOptions& options) {
  const int total = FlightsOf(table, options);
  int done = 0;
  Json rows = Json::array();
  for (const ReproducedRow& row : table.rows) {
    const Scenario base = BaseOf(row, options.scenarios);
    const std::size_t method = PositionOf(row.estimator, base);
    Json json = {{"method", row.method}, {"preset", row.preset}, {"set", row.overrides}};
    for (int s = 0; s < 2; ++s) {
      std::vector<Tally> flights;
      for (int seed = 1; seed <= options.n_seeds; ++seed) {
        for (int flight = 0; flight < base.dataset.Of(kScored[s]).flights; ++flight) {
          const auto data_seed = static_cast<std::uint64_t>(seed);
          flights.push_back(
              FlyAndScore(DatasetFlight(base, kScored[s], flight, data_seed), method, options));
          if (options.on_flight) options.on_flight(++done, total);
        }
      }
      Json score = {{"seeds", options.n_seeds}};
      for (const Quantity& quantity : kQuantities) {
        AddQuantity(quantity, flights, options.n_seeds, &score);
      }
      json[kScoredNames[s]] = std::move(score);
    }
    json["paper"] = {{"val", Published(row.paper_val)}, {"test", Published(row.paper_test)}};
    rows.push_back(std::move(json));
  }
  return {{"table", table.name}, {"meaning", table.meaning}, {"rows", std::move(rows)}};
}

std::string ReproducedText(const Json& table) {
  const auto cell = [](const Json& score, const char* key) {
    if (!score.contains(key)) return std::string();
    const std::string mean = fmt::format("{:.3f}", score[key].get<double>());
    if (!score.contains("sd")) return mean;
    return fmt::format("{}±{:.3f}", mean, score["sd"][key].get<double>());
  };
  std::string text =
      fmt::format("{}: {}\n{:<36} {:<6} {:>12} {:>12} {:>12} {:>12} {:>8}\n",
                  table["table"].get<std::string>(), table["meaning"].get<std::string>(), "", "",
                  "Abs Rel", "Sq Rel", "< 20 m", "> 20 m", "under");
  for (const Json& row : table["rows"]) {
    for (const char* split : kScoredNames) {
      const auto line = [&](const std::string& name, const char* who, const Json& score) {
        const std::string under =
            score.contains("under_estimated")
                ? fmt::format("{:.1f} %", 100 * score["under_estimated"].get<double>())
                : "";
        // "±" is one column wide and two bytes long, which fmt knows.
        text += fmt::format("{:<36} {:<6} {:>12} {:>12} {:>12} {:>12} {:>8}\n", name, who,
                            cell(score, "abs_rel"), cell(score, "sq_rel"), cell(score, "lt20"),
                            cell(score, "gt20"), under);
      };
      line(split == kScoredNames[0] ? row["method"].get<std::string>() : "", split, row[split]);
      const Json& paper = row["paper"][split];
      if (!paper.empty()) line("", "paper", paper);
    }
  }
  return text;
}

}  // namespace windhover
