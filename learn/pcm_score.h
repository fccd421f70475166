#pragma once

#include <span>

#include "estimator/pcm.h"

namespace windhover {

/// A detection to learn from.
struct PcmSample {
  CorrectableBoxes boxes;
  float label_m;
};

/// Scores of an estimator on samples, as the paper's tables have them. What is no distance counts
/// as an error of 1.
struct PcmScore {
  double abs_rel = 0, sq_rel = 0;
  double lt20 = 0, gt20 = 0;  ///< Abs Rel of labels below and above 20 m.
  double rms_rel = 0;         ///< Root mean square of the relative error.
  double n_stages = 0;        ///< Mean.
};

struct RangedSample {
  float range_m, label_m;
  int n_stages;
};
PcmScore Score(std::span<const RangedSample> samples);

PcmScore ScorePcm(const PcmStages& stages, FurtherStages further,
                  std::span<const PcmSample> samples);

}  // namespace windhover
