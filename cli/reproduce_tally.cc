#include "cli/reproduce_tally.h"

#include <algorithm>
#include <cmath>

#include "eval/metrics.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

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

/// Mean of `quantity` over data sets of equally many flights each, with its spread and interval.
void AddQuantity(const Quantity& quantity, const std::vector<Tally>& flights, int n_seeds,
                 Json* score) {
  const std::size_t per_set = flights.size() / static_cast<std::size_t>(n_seeds);
  std::vector<BlockSum> blocks;
  double sum = 0, squares = 0;
  int n_terms = 0;
  for (std::size_t begin = 0; begin < flights.size(); begin += per_set) {
    BlockSum set;
    for (std::size_t i = begin; i < begin + per_set; ++i) {
      const BlockSum& flight = flights[i].*quantity.sum;
      blocks.push_back(flight);
      set.sum += flight.sum;
      set.count += flight.count;
    }
    n_terms += set.count;
    const double mean = set.count > 0 ? set.sum / set.count : 0;
    sum += mean;
    squares += mean * mean;
  }
  if (n_terms == 0) return;
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

}  // namespace

void Tally::Add(double reference_m, double range_m) {
  const double error_m = range_m - reference_m, relative = std::abs(error_m) / reference_m;
  const auto add = [](BlockSum* to, double term) {
    to->sum += term;
    ++to->count;
  };
  add(&abs_rel, relative);
  add(&sq_rel, error_m * error_m / reference_m);
  add(reference_m < kNearFar_m ? &near : &far, relative);
  add(&under, error_m < 0 ? 1 : 0);
  auto& bin = bins[static_cast<int>(reference_m / kDistanceBin_m)];
  add(&bin[0], relative);
  add(&bin[1], range_m);
  add(&bin[2], reference_m);
}

std::vector<Tally> TalliesOf(const std::vector<TriedFrame>& frames,
                             const std::vector<std::size_t>& row_of, std::size_t n_rows) {
  std::vector<Tally> tallies(n_rows);
  for (const TriedFrame& frame : frames) {
    bool is_shared = true;
    for (std::size_t m = 0; m < row_of.size(); ++m) {
      is_shared = is_shared && frame.range_m[m].has_value();
      ++tallies[row_of[m]].detected.count;
      tallies[row_of[m]].detected.sum += frame.range_m[m].has_value();
    }
    for (std::size_t m = 0; m < row_of.size() && is_shared; ++m) {
      tallies[row_of[m]].Add(frame.reference_m, *frame.range_m[m]);
    }
  }
  return tallies;
}

Json ScoreOf(const std::vector<Tally>& flights, int n_seeds) {
  Json score = {{"seeds", n_seeds}, {"frames", 0}};
  for (const Tally& flight : flights) {
    score["frames"] = score["frames"].get<int>() + flight.abs_rel.count;
  }
  for (const Quantity& quantity : kQuantities) AddQuantity(quantity, flights, n_seeds, &score);
  return score;
}

Json ByDistance(const std::vector<Tally>& flights) {
  std::map<int, std::array<BlockSum, 3>> bins;
  for (const Tally& flight : flights) {
    for (const auto& [bin, sums] : flight.bins) {
      for (std::size_t i = 0; i < sums.size(); ++i) {
        bins[bin][i].sum += sums[i].sum;
        bins[bin][i].count += sums[i].count;
      }
    }
  }
  Json json = Json::array();
  for (const auto& [bin, sums] : bins) {
    json.push_back({{"from_m", bin * kDistanceBin_m},
                    {"to_m", (bin + 1) * kDistanceBin_m},
                    {"n", sums[0].count},
                    {"abs_rel", sums[0].sum / sums[0].count},
                    {"range_m", sums[1].sum / sums[1].count},
                    {"mean_reference_m", sums[2].sum / sums[2].count}});
  }
  return json;
}

}  // namespace windhover
