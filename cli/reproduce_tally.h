#pragma once

#include <array>
#include <map>
#include <vector>

#include <nlohmann/json.hpp>

#include "eval/bootstrap.h"
#include "learn/method_trial.h"

namespace windhover {

/// Sums over the frames of a flight, or of pictures of one place; a share or mean is its sum by its
/// count.
struct Tally {
  BlockSum abs_rel, sq_rel, near, far, under, detected;
  std::map<int, std::array<BlockSum, 3>>
      bins;  ///< By distance: relative error, distance told, reference.

  void Add(double reference_m, double range_m);
};

/// What `n_rows` rows of a table made of the same frames. `row_of` says whose each method is. Those
/// frames count for which all methods have a distance; `detected` is over all.
std::vector<Tally> TalliesOf(const std::vector<TriedFrame>& frames,
                             const std::vector<std::size_t>& row_of, std::size_t n_rows);

/// A row's score: means over `n_seeds` data sets, of equally many of `flights` each, with their
/// spread ("sd") and intervals ("ci95"). What no frame tells is left out.
nlohmann::ordered_json ScoreOf(const std::vector<Tally>& flights, int n_seeds);

nlohmann::ordered_json ByDistance(const std::vector<Tally>& flights);

}  // namespace windhover
