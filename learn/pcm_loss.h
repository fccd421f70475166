#pragma once

#include "estimator/pcm.h"

namespace windhover {

/// What a correction is punished for, of its distance d and the label d*.
enum class PcmLoss {
  kSquared,  ///< (d - d*)², the paper's.
  kLog,      ///< Huber's function of log(d / d*), linear beyond 0.1.
};

/// Derivative of the loss by the disparity, and the relative error.
struct LossSlope {
  float by_disparity, relative_error;
};

/// @param disparity of the corrected positions, in image widths; of either sign.
LossSlope SlopeOf(PcmLoss loss, const CorrectableBoxes& boxes, float disparity, float label_m);

/// Derivative by the margin, hard's logit less easy's, of the cross entropy of the softmax.
float GateSlopeOf(float margin, bool is_hard);

}  // namespace windhover
