#pragma once

#include <vector>

#include "estimator/self_calibration_filter.h"

namespace windhover {

/// One way in which rig and target may be: how probable it is, and what it changes in the model.
struct SelfCalibrationHypothesis {
  double weight = 1;  ///< Prior probability, relative to the others.
  double size_bias = 0;
  double size_bias_sigma = 0;
  double offset_sigma_px = 0;
};

/// A bias of sizes that is normal about 0 and cut off at ±`reach`, as `n` narrow ones which
/// together have `weight`. An infinite `sigma` makes all biases within reach alike probable.
/// @pre n >= 2
std::vector<SelfCalibrationHypothesis> SplitSizeBias(double weight, double sigma, double reach,
                                                     int n, double offset_sigma_px);

/// Filters that differ in what they expect at first, weighted by how well they foretell what
/// comes. One extended Kalman filter with wide priors is over-confident: each linearisation at a
/// range that is wrong by a common factor gives it knowledge of that factor that it does not
/// have. With a narrow prior for the size its range is known well enough to be linear in,
/// whatever the offset, and the data choose among sizes.
///
/// A target that appears may be another kind: the prior weights then get a tenth of the say back.
/// Source: Bar-Shalom et al. 2001, 11.6.2 (static multiple models).
class SelfCalibrationBank {
 public:
  /// @param hypotheses one or more.
  SelfCalibrationBank(const SelfCalibrationModel& model,
                      const std::vector<SelfCalibrationHypothesis>& hypotheses);

  /// Mean and standard deviation of all filters' beliefs.
  SelfCalibrationFilter::Belief Observe(const SelfCalibrationFilter::Sighting& sighting);

  /// Of the disparity: measured minus true.
  double offset_px() const;
  double offset_sigma_px() const;

 private:
  struct Member {
    double prior, weight, size_bias;
    SelfCalibrationFilter filter;
  };

  void Welcome(int track_id);
  void Weigh(const std::vector<SelfCalibrationFilter::Belief>& beliefs);

  std::vector<Member> members_;
  std::vector<SelfCalibrationFilter::Belief> beliefs_;
  std::vector<int> known_tracks_;  ///< The latest ones.
};

}  // namespace windhover
