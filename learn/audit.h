#pragma once

#include <functional>
#include <string>
#include <vector>

#include "learn/stereo_tuple.h"
#include "learn/train_card.h"

namespace windhover {

/// One question about what a correction learned, and its answer.
struct AuditFinding {
  std::string question;
  double baseline, offset1, pcm;  ///< Abs Rel on the test split.
  std::string verdict;            ///< In plain words.
};

/// Draws the data set of the scenario under audit with `overrides` ("a.b.c=value").
using DrawAudited = std::function<TupleSplits(const std::vector<std::string>& overrides)>;

/// Asks of `recipe`, trained on what `draw` gives: what is left without widths and heights, with
/// those of other boxes, for a target 1.4 times as large; what it makes of vibration alone, and
/// whether one constant offset does as well where only that is wrong. `offset1` is the median
/// offset of the training split; one stage is trained.
std::vector<AuditFinding> Audit(const StereoRig& rig, const PcmRecipe& recipe,
                                const DrawAudited& draw);

/// Median over samples of what disparities are too large, in image widths.
/// @pre there are samples.
float MedianOffset(const std::vector<PcmSample>& samples);

/// Scores of triangulation with `offset` taken from disparities.
PcmScore ScoreOffset(const std::vector<PcmSample>& samples, float offset);

/// The findings for a terminal.
std::string AuditText(const std::vector<AuditFinding>& findings);

}  // namespace windhover
