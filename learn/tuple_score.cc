#include "learn/tuple_score.h"

#include <algorithm>
#include <memory>

#include "estimator/range_estimator.h"

namespace windhover {
namespace {

// Two blocks of the bootstrap (eval/metrics.h), so that none has frames of two flights.
constexpr Utime kBetweenFlights = 2 * static_cast<Utime>(kMinBlock_s * 1e6);

// Of one method; flights follow each other in time.
std::vector<ScoredFrame> Ranged(const std::vector<StereoTuple>& tuples, const std::string& method,
                                const AircraftConfig& config) {
  std::vector<ScoredFrame> frames;
  std::unique_ptr<RangeEstimator> estimator;
  Utime begin = 0, last = 0;
  for (std::size_t i = 0; i < tuples.size(); ++i) {
    const StereoTuple& tuple = tuples[i];
    if (i == 0 || tuple.flight != tuples[i - 1].flight) {
      estimator = MakeRangeEstimator(method, config);
      begin = i == 0 ? 0 : last + kBetweenFlights;
      begin -= tuple.utime;
    }
    const auto solution = estimator->Estimate({.box = tuple.box, .utime = tuple.utime});
    last = begin + tuple.utime;
    ScoredFrame& frame = frames.emplace_back();
    frame.utime = last;
    frame.reference_m = tuple.range_m;
    if (!solution) continue;
    frame.estimate_m = solution->range_m;
    frame.sigma_m = solution->range_sigma_m;
  }
  return frames;
}

}  // namespace

std::vector<MethodScore> ScoreTuples(const std::vector<StereoTuple>& tuples,
                                     const AircraftConfig& config) {
  std::vector<std::vector<ScoredFrame>> frames;
  for (const std::string& method : config.estimator.methods) {
    frames.push_back(Ranged(tuples, method, config));
  }
  return ScoreMethods(config.estimator.methods, frames, 1 / config.frame_rate_hz, /*seed=*/1);
}

}  // namespace windhover
