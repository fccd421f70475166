#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenarios/scenario.h"

namespace windhover {

/// A method of estimator.methods with what it has learned.
struct TrialMethod {
  std::string method;
  std::string card;  ///< The file of estimator.correction; empty: the scenario's.
};

/// `config` with this method alone, and its card.
AircraftConfig ConfigFor(const TrialMethod& method, AircraftConfig config);

/// A frame that a score counts, and the distance by each method that has one.
struct TriedFrame {
  double reference_m = 0;
  std::vector<std::optional<double>> range_m;
};

/// Flies each of `flights` (learn/geometric_flight.h) once and gives every method the same
/// detections: the numbers that a run with these methods and its score would give.
/// @return the frames of each flight, the same on any number of `threads`.
/// @throws as GeometricFlight and MakeRangeEstimator.
std::vector<std::vector<TriedFrame>> TryMethods(const std::vector<Scenario>& flights,
                                                const std::vector<TrialMethod>& methods,
                                                int threads);

/// Time of one call of a method on this machine, on detections of `flight`: the least of several
/// rounds, in microseconds.
double TimeOf_us(const Scenario& flight, const TrialMethod& method);

/// Size of one position correction module or gate of the authors' width.
struct ModuleSize {
  int parameters;
  double operations;  ///< For both boxes of a pair (estimator/mixer.h).
};
ModuleSize SizeOfModule(int n_outputs);

}  // namespace windhover
