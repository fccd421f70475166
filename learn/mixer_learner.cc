#include "learn/mixer_learner.h"

#include <cmath>
#include <stdexcept>

#include "common/random/random_stream.h"
#include "estimator/mixer_pass.h"

namespace windhover {
namespace {

std::vector<float> InitialParameters(int width, int n_outputs, bool zero_head,
                                     RandomStream* random) {
  const int hidden = width / 2, tokens = kBoxTokens, token_hidden = MixerLayout<4>::kTokenHidden;
  std::vector<float> p;
  // As torch's Linear starts: uniform within 1/sqrt(inputs).
  const auto linear = [&](int outputs, int inputs, double scale = 1) {
    const double bound = scale / std::sqrt(inputs);
    for (int i = 0; i < outputs * (inputs + 1); ++i) {
      p.push_back(static_cast<float>(random->Uniform(-bound, bound)));
    }
  };
  const auto norm = [&] {
    p.insert(p.end(), static_cast<std::size_t>(width), 1.0f);
    p.insert(p.end(), static_cast<std::size_t>(width), 0.0f);
  };
  linear(width, 1);
  for (int b = 0; b < MixerLayout<4>::kBlocks; ++b) {
    norm();
    linear(token_hidden, tokens);
    linear(tokens, token_hidden);
    norm();
    linear(hidden, width);
    linear(width, hidden);
  }
  norm();
  linear(n_outputs, width, zero_head ? 0 : 1);
  return p;
}

}  // namespace

MixerLearner::MixerLearner(int width, int n_outputs, const OptimiserConfig& config, bool zero_head,
                           std::uint64_t seed, const std::string& name)
    : kernel(MakeMixerKernel(width, n_outputs)),
      optimiser(config, static_cast<std::size_t>(MixerParameters(width, n_outputs))) {
  RandomStream random(seed, name);
  parameters = InitialParameters(width, n_outputs, zero_head, &random);
}

bool MixerLearner::Step(double rate) {
  kernel->TakeGradient(&gradient);
  return optimiser.Step(rate, gradient, &parameters);
}

nlohmann::json MixerLearner::State() const {
  const Optimiser::Memory& memory = optimiser.memory();
  return {parameters, memory.first, memory.second, memory.steps};
}

void MixerLearner::Restore(const nlohmann::json& state) {
  const std::size_t n = parameters.size();
  parameters = NumbersFrom(state.at(0), n);
  Optimiser::Memory memory = optimiser.memory();
  memory.first = NumbersFrom(state.at(1), n);
  memory.second = NumbersFrom(state.at(2), memory.second.size());
  memory.steps = state.at(3).get<int>();
  optimiser.Restore(std::move(memory));
}

std::vector<float> NumbersFrom(const nlohmann::json& json, std::size_t size) {
  auto values = json.get<std::vector<float>>();
  if (values.size() != size) throw std::invalid_argument("wrong number of parameters");
  return values;
}

}  // namespace windhover
