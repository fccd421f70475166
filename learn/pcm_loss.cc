#include "learn/pcm_loss.h"

#include <algorithm>
#include <cmath>

namespace windhover {
namespace {

constexpr float kHuber = 0.1f;  // Of log d: gross detections pull no harder than this.

}  // namespace

LossSlope SlopeOf(PcmLoss loss, const CorrectableBoxes& boxes, float disparity, float label_m) {
  if (loss == PcmLoss::kSquared) {  // As the authors', of the distance of either sign's parallax.
    const float held = std::copysign(std::max(std::abs(disparity), 1e-9f), disparity);
    const float d_m = boxes.Range_m(std::abs(held)), error_m = d_m - label_m;
    return {2 * error_m * -d_m / held, std::abs(error_m) / label_m};
  }
  const float least = 2 / boxes.image_width_px;  // Below, the slope stays: back to parallax.
  const float held = std::max(disparity, least);
  const float ratio = boxes.Range_m(held) / label_m;
  return {-std::clamp(std::log(ratio), -kHuber, kHuber) / held, std::abs(ratio - 1)};
}

float GateSlopeOf(float margin, bool is_hard) {
  const float hard = 1 / (1 + std::exp(-margin));
  return hard - (is_hard ? 1.0f : 0.0f);
}

}  // namespace windhover
