#pragma once

#include <vector>

#include "common/time/sim_time.h"

namespace windhover {

/// Learns how noisy disparities of box centres are: σ² = constant² + (relative · width)², with the
/// constant given and `relative` estimated. Detectors differ in it (1 % to 5 % of a box), and a
/// filter that takes near disparities for better than they are never gets over its first frames.
///
/// Second differences in time, divided by √6, have the variance of the noise and hardly anything
/// of the motion. Each is a measurement of relative²; their weighted mean starts from a
/// prior as uncertain as it is large.
class DisparityNoise {
 public:
  DisparityNoise(double sigma_px, double relative);

  /// Takes note of a track's disparity; in order of time.
  void Observe(Utime utime, int track_id, double disparity_px, double width_px);

  double SigmaPx(double width_px) const;
  double relative() const;

 private:
  struct Recent {
    int track_id;
    int n;              ///< Successive frames, at most 2.
    Utime utime, step;  ///< Of the last one, and from the one before.
    double last_px, before_px;
  };

  void Learn(double second_difference_px, double width_px);

  double variance_px2_;
  double square_, information_;  ///< relative², and the inverse of its variance.
  double least_square_;
  std::vector<Recent> recent_;
};

}  // namespace windhover
