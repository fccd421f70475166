#pragma once

#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "learn/mixer_kernel.h"
#include "learn/optimiser.h"

namespace windhover {

/// A mixer in training.
struct MixerLearner {
  std::unique_ptr<MixerKernel> kernel;
  std::vector<float> parameters;
  Optimiser optimiser;
  std::vector<float> gradient;

  /// Starts as torch's modules do, drawn from the stream `name` of `seed`; its head with zeros if
  /// `zero_head`.
  MixerLearner(int width, int n_outputs, const OptimiserConfig& config, bool zero_head,
               std::uint64_t seed, const std::string& name);

  /// Follows the gradient that the kernel has gathered. @return false if it is not finite.
  bool Step(double rate);

  /// Parameters and all that the optimiser remembers.
  nlohmann::json State() const;
  /// @throws std::invalid_argument or nlohmann::json::exception if it is no state of this mixer.
  void Restore(const nlohmann::json& state);
};

/// A list of `size` numbers. @throws as MixerLearner::Restore()
std::vector<float> NumbersFrom(const nlohmann::json& json, std::size_t size);

}  // namespace windhover
