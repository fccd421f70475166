#include "estimator/disparity_noise.h"

#include <algorithm>
#include <cmath>

namespace windhover {
namespace {

constexpr Utime kLongestStep = 300'000;
constexpr Utime kForgetAfter = 1'500'000;
constexpr double kLargest = 9;  // Second differences beyond three sigmas count as that.
// Successive second differences share two of three terms; so many make one independent one.
constexpr double kShared = 2;

}  // namespace

DisparityNoise::DisparityNoise(double sigma_px, double relative)
    : variance_px2_(sigma_px * sigma_px),
      square_(std::max(relative * relative, 1e-8)),
      information_(1 / (square_ * square_)),
      least_square_(square_ * 1e-2) {}

double DisparityNoise::SigmaPx(double width_px) const {
  return std::sqrt(variance_px2_ + square_ * width_px * width_px);
}

double DisparityNoise::relative() const { return std::sqrt(square_); }

void DisparityNoise::Observe(Utime utime, int track_id, double disparity_px, double width_px) {
  std::erase_if(recent_, [&](const Recent& r) { return utime - r.utime > kForgetAfter; });
  auto found = std::find_if(recent_.begin(), recent_.end(),
                            [&](const Recent& r) { return r.track_id == track_id; });
  if (found == recent_.end()) {
    recent_.push_back({track_id, 1, utime, 0, disparity_px, 0});
    return;
  }
  const Utime step = utime - found->utime;
  const bool follows = step > 0 && step <= kLongestStep;
  if (follows && found->n == 2 && step == found->step) {
    Learn((disparity_px - 2 * found->last_px + found->before_px) / std::sqrt(6.0), width_px);
  }
  *found = {track_id, follows ? 2 : 1, utime, step, disparity_px, found->last_px};
}

void DisparityNoise::Learn(double second_difference_px, double width_px) {
  const double expected = variance_px2_ + square_ * width_px * width_px;
  const double square = std::min(second_difference_px * second_difference_px, kLargest * expected);
  // d(square) / d(relative²), and the variance of a normal variable's square.
  const double by_square = width_px * width_px;
  const double information = by_square * by_square / (2 * expected * expected) / kShared;
  information_ += information;
  square_ += information / information_ * (square - expected) / by_square;
  square_ = std::max(square_, least_square_);
}

}  // namespace windhover
