#include "learn/optimiser.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace windhover {

Optimiser::Optimiser(const OptimiserConfig& config, std::size_t n_parameters) : config_(config) {
  memory_.first.assign(n_parameters, 0);
  if (config.kind == OptimiserKind::kAdamW) memory_.second.assign(n_parameters, 0);
}

bool Optimiser::Step(double rate, const std::vector<float>& gradient,
                     std::vector<float>* parameters) {
  double squares = 0;
  for (const float g : gradient) squares += static_cast<double>(g) * g;
  if (!std::isfinite(squares)) return false;
  const double norm = std::sqrt(squares);
  const auto shrink =
      static_cast<float>(config_.clip > 0 ? std::min(1.0, config_.clip / (norm + 1e-6)) : 1.0);
  const auto decay = static_cast<float>(config_.weight_decay);
  const auto momentum = static_cast<float>(config_.momentum);
  const auto step = static_cast<float>(rate);
  ++memory_.steps;
  std::vector<float>& p = *parameters;
  if (config_.kind == OptimiserKind::kSgd) {
    for (std::size_t i = 0; i < p.size(); ++i) {
      memory_.first[i] = momentum * memory_.first[i] + (gradient[i] * shrink + decay * p[i]);
      p[i] -= step * memory_.first[i];
    }
    return true;
  }
  constexpr float kBeta2 = 0.999f, kEpsilon = 1e-8f;
  const auto n = static_cast<double>(memory_.steps);
  const auto unbias1 = static_cast<float>(1 / (1 - std::pow(config_.momentum, n)));
  const auto unbias2 = static_cast<float>(1 / (1 - std::pow(0.999, n)));
  for (std::size_t i = 0; i < p.size(); ++i) {
    const float g = gradient[i] * shrink;
    memory_.first[i] = momentum * memory_.first[i] + (1 - momentum) * g;
    memory_.second[i] = kBeta2 * memory_.second[i] + (1 - kBeta2) * g * g;
    const float scale = std::sqrt(memory_.second[i] * unbias2) + kEpsilon;
    p[i] -= step * (decay * p[i] + memory_.first[i] * unbias1 / scale);
  }
  return true;
}

double RateShare(int epoch, int n_epochs, int n_warm_up) {
  if (epoch < n_warm_up) return static_cast<double>(epoch + 1) / n_warm_up;
  const double done = static_cast<double>(epoch - n_warm_up) / std::max(1, n_epochs - n_warm_up);
  return 0.5 * (1 + std::cos(std::numbers::pi * done));
}

}  // namespace windhover
