#include "learn/pcm_score.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace windhover {

PcmScore Score(std::span<const RangedSample> samples) {
  PcmScore score;
  int n_near = 0;
  for (const RangedSample& sample : samples) {
    const bool is_range = std::isfinite(sample.range_m) && sample.range_m > 0;
    const double relative = is_range ? std::abs(sample.range_m / sample.label_m - 1.0) : 1.0;
    score.abs_rel += relative;
    score.sq_rel += relative * relative * sample.label_m;
    score.rms_rel += relative * relative;
    score.n_stages += sample.n_stages;
    (sample.label_m < 20 ? score.lt20 : score.gt20) += relative;
    n_near += sample.label_m < 20;
  }
  const auto n = std::max(1.0, static_cast<double>(samples.size()));
  score.abs_rel /= n;
  score.sq_rel /= n;
  score.rms_rel = std::sqrt(score.rms_rel / n);
  score.n_stages /= n;
  score.lt20 /= std::max(1, n_near);
  score.gt20 /= std::max(1.0, n - n_near);
  return score;
}

PcmScore ScorePcm(const PcmStages& stages, FurtherStages further,
                  std::span<const PcmSample> samples) {
  std::vector<RangedSample> ranged;
  for (const PcmSample& sample : samples) {
    const Correction corrected = Correct(stages, sample.boxes, further);
    ranged.push_back(
        {sample.boxes.Range_m(corrected.boxes.Disparity()), sample.label_m, corrected.n_stages});
  }
  return Score(ranged);
}

}  // namespace windhover
