#include "rig/box_noise.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/random/random_stream.h"

namespace windhover {
namespace {

// More than a tick draws, so that ticks share no draws.
constexpr std::uint64_t kDrawsPerTick = 16;

// The rehearsal is tick -1.
RandomStream StreamAt(std::uint64_t seed, const std::string& name, int tick) {
  RandomStream stream(seed, name);
  stream.Seek(static_cast<std::uint64_t>(tick + 1) * kDrawsPerTick);
  return stream;
}

// Adds to `value` of both images a correlated pair of normal errors of these deviations.
void AddPair(double correlation, double left_px, double right_px,
             double BoxErrors::OneImage::*value, RandomStream* stream, BoxErrors* errors) {
  const double common = std::sqrt(std::abs(correlation));
  const double own = std::sqrt(1 - std::abs(correlation));
  const double shared = stream->Normal(), left = stream->Normal(), right = stream->Normal();
  errors->left.*value += left_px * (common * shared + own * left);
  errors->right.*value += right_px * (std::copysign(common, correlation) * shared + own * right);
}

void AddGrossError(const GeometricConfig& config, const BoxSize& size, RandomStream* stream,
                   BoxErrors::OneImage* error) {
  const bool is_gross = stream->Uniform() < config.gross_rate;
  const double relative = config.gross_sigma * stream->Normal();
  if (!is_gross) return;
  error->x += relative * size[0];
  error->y += relative * size[1];
}

}  // namespace

double MissProbability(const GeometricConfig& config, double width_px) {
  if (config.miss_width_px == 0) return config.miss_rate;
  const double narrow =
      1 / (1 + std::exp((width_px - config.miss_width_px) / config.miss_softness_px));
  return config.miss_rate + (1 - config.miss_rate) * narrow;
}

double CorrelationOfX(const GeometricConfig& config, double width_px) {
  if (config.correlation_width_px == 0) return config.correlation;
  const double more = 1 + std::pow(width_px / config.correlation_width_px, 2);
  const double shared = std::max(0.0, 1 - (1 - std::abs(config.correlation)) * more);
  return std::copysign(shared, config.correlation);
}

BoxNoise::BoxNoise(const GeometricConfig& config, std::uint64_t seed, std::string name)
    : config_(config), seed_(seed), name_(std::move(name)) {}

std::optional<BoxErrors> BoxNoise::At(int tick, const BoxSize& left, const BoxSize& right) const {
  RandomStream stream = StreamAt(seed_, name_, tick);
  if (stream.Uniform() < MissProbability(config_, std::min(left[0], right[0]))) return std::nullopt;
  BoxErrors errors;
  const auto add = [&](double BoxErrors::OneImage::*value, int side, double factor,
                       double correlation) {
    const auto sigma_px = [&](const BoxSize& size) {
      return factor * std::hypot(config_.sigma_px, config_.sigma_relative * size[side]);
    };
    AddPair(correlation, sigma_px(left), sigma_px(right), value, &stream, &errors);
  };
  add(&BoxErrors::OneImage::x, 0, 1, CorrelationOfX(config_, (left[0] + right[0]) / 2));
  add(&BoxErrors::OneImage::y, 1, 1, config_.correlation);
  add(&BoxErrors::OneImage::w, 0, config_.size_factor, config_.correlation);
  add(&BoxErrors::OneImage::h, 1, config_.size_factor, config_.correlation);
  if (config_.gross_rate > 0) {
    RandomStream gross = StreamAt(seed_, name_ + "/gross", tick);
    AddGrossError(config_, left, &gross, &errors.left);
    AddGrossError(config_, right, &gross, &errors.right);
  }
  return errors;
}

}  // namespace windhover
