#include "learn/method_trial.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include "estimator/mixer.h"
#include "estimator/rig_estimators.h"
#include "learn/geometric_flight.h"
#include "render/parallel_for.h"

namespace windhover {
namespace {

std::vector<RigEstimators> EstimatorsOf(const Scenario& flight,
                                        const std::vector<TrialMethod>& methods) {
  std::vector<RigEstimators> estimators;
  for (const TrialMethod& method : methods) {
    estimators.emplace_back(ConfigFor(method, flight.ForAircraft()));
  }
  return estimators;
}

std::vector<TriedFrame> TryOn(const Scenario& scenario, const std::vector<TrialMethod>& methods) {
  std::vector<RigEstimators> estimators = EstimatorsOf(scenario, methods);
  std::vector<TriedFrame> tried;
  GeometricFlight flight(scenario);
  while (const auto frame = flight.Next()) {
    std::vector<stereo_box_t> boxes;
    if (frame->box) boxes.push_back(*frame->box);
    const nav_state_t nav = flight.Nav();
    TriedFrame result;
    for (RigEstimators& estimator : estimators) {
      const range_t ranges = estimator.Estimate(frame->utime, nav, boxes);
      std::optional<double> range_m;
      if (frame->box_is_of_target && ranges.estimates[0].status == range_estimate_t::STATUS_OK) {
        range_m = ranges.estimates[0].range_m;
      }
      result.range_m.push_back(range_m);
    }
    if (!frame->reference_m) continue;
    result.reference_m = *frame->reference_m;
    tried.push_back(std::move(result));
  }
  return tried;
}

}  // namespace

AircraftConfig ConfigFor(const TrialMethod& method, AircraftConfig config) {
  config.estimator.methods = {method.method};
  if (!method.card.empty()) config.estimator.correction = {method.card, method.card, "the table"};
  return config;
}

std::vector<std::vector<TriedFrame>> TryMethods(const std::vector<Scenario>& flights,
                                                const std::vector<TrialMethod>& methods,
                                                int threads) {
  std::vector<std::vector<TriedFrame>> tried(flights.size());
  ParallelFor(static_cast<int>(flights.size()), threads, [&](int task, int /*worker*/) {
    const auto i = static_cast<std::size_t>(task);
    tried[i] = TryOn(flights[i], methods);
  });
  return tried;
}

double TimeOf_us(const Scenario& scenario, const TrialMethod& method) {
  const AircraftConfig config = ConfigFor(method, scenario.ForAircraft());
  std::vector<StereoObservation> observations;
  GeometricFlight flight(scenario);
  while (const auto frame = flight.Next()) {
    if (frame->box) observations.push_back({.box = *frame->box, .utime = frame->utime});
  }
  using Clock = std::chrono::steady_clock;
  double least_us = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 20; ++round) {
    const auto estimator = MakeRangeEstimator(method.method, config);
    const Clock::time_point start = Clock::now();
    for (const StereoObservation& observation : observations) estimator->Estimate(observation);
    const std::chrono::duration<double, std::micro> taken = Clock::now() - start;
    least_us = std::min(least_us, taken.count() / static_cast<double>(observations.size()));
  }
  return least_us;
}

ModuleSize SizeOfModule(int n_outputs) {
  const int width = kMixerWidths.front();
  return {MixerParameters(width, n_outputs), 2 * MixerOperations(width, n_outputs)};
}

}  // namespace windhover
