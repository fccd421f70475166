#include "learn/tuple_source.h"

#include <array>

#include "learn/geometric_flight.h"
#include "render/parallel_for.h"
#include "scenarios/dataset.h"

namespace windhover {
namespace {

struct Flight {
  Split split;
  int number;
  std::vector<StereoTuple> tuples;
};

std::vector<StereoTuple> TuplesOf(const Scenario& scenario, int number) {
  std::vector<StereoTuple> tuples;
  GeometricFlight flight(scenario);
  while (const auto frame = flight.Next()) {
    if (!frame->box_is_of_target || !frame->reference_m) continue;
    tuples.push_back({.box = *frame->box,
                      .range_m = *frame->reference_m,
                      .range_true_m = frame->range_m,
                      .flight = number,
                      .utime = frame->utime});
  }
  return tuples;
}

std::vector<StereoTuple>& Of(Split split, TupleSplits* splits) {
  return split == Split::kTrain ? splits->train : split == Split::kVal ? splits->val : splits->test;
}

}  // namespace

TupleSplits DrawTuples(const Scenario& base, std::uint64_t seed, int threads) {
  std::vector<Flight> flights;
  for (const Split split : {Split::kTrain, Split::kVal, Split::kTest}) {
    for (int i = 0; i < base.dataset.Of(split).flights; ++i) flights.push_back({split, i, {}});
  }
  ParallelFor(static_cast<int>(flights.size()), threads, [&](int task, int /*worker*/) {
    Flight& flight = flights[static_cast<std::size_t>(task)];
    flight.tuples = TuplesOf(DatasetFlight(base, flight.split, flight.number, seed), flight.number);
  });
  TupleSplits splits;
  for (const Flight& flight : flights) {
    std::vector<StereoTuple>& all = Of(flight.split, &splits);
    all.insert(all.end(), flight.tuples.begin(), flight.tuples.end());
  }
  return splits;
}

}  // namespace windhover
