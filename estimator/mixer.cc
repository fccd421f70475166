#include "estimator/mixer.h"

#include <stdexcept>

#include <fmt/format.h>

#include "estimator/mixer_pass.h"

namespace windhover {
namespace {

using Pair = FloatLanes<4>::Type;  // Left and right; two lanes stay empty.

template <int kWidth, int kOutputs>
std::array<std::array<float, 2>, 2> EvaluateAs(const float* parameters, const BoxTokens& left,
                                               const BoxTokens& right) {
  MixerPass<kWidth, kOutputs, Pair, /*kTraining=*/false> pass;
  std::array<Pair, kBoxTokens> x{};
  for (std::size_t i = 0; i < kBoxTokens; ++i) x[i] = Pair{left[i], right[i], 0, 0};
  std::array<Pair, kOutputs> out;
  pass.Forward(parameters, x, &out);
  std::array<std::array<float, 2>, 2> result{};
  for (int side = 0; side < 2; ++side) {
    for (int k = 0; k < kOutputs; ++k) result[side][k] = out[k][side];
  }
  return result;
}

// --- Width 4: a vector is the four channels of a token, so that no lane is empty. ---------------

using Four = FloatLanes<4>::Type;
using Layout = MixerLayout<4>;
constexpr int kSides = 2;

/// The tokens of both boxes, by side, then token.
struct State {
  Four of[kSides][kBoxTokens];
};

Four Load(const float* from) { return Four{from[0], from[1], from[2], from[3]}; }

Four SumInAll(const Four& v) {
  const Four pairs = v + __builtin_shufflevector(v, v, 1, 0, 3, 2);
  return pairs + __builtin_shufflevector(pairs, pairs, 2, 3, 0, 1);
}

void Normalise(const State& x, const float* p, State* u) {
  const Four weight = Load(p), bias = Load(p + 4);
  for (int side = 0; side < kSides; ++side) {
    for (int i = 0; i < kBoxTokens; ++i) {
      const Four off = x.of[side][i] - SumInAll(x.of[side][i]) * 0.25f;
      const Four variance = SumInAll(off * off) * 0.25f + 1e-5f;
      Four inverse_sigma;
      InverseSqrt(variance, &inverse_sigma);
      u->of[side][i] = off * inverse_sigma * weight + bias;
    }
  }
}

void MixTokens(const State& u, const float* block, State* x) {
  constexpr int kHidden = Layout::kTokenHidden;
  Four hidden[kHidden][kSides], unused;
  for (int h = 0; h < kHidden; ++h) {
    Four sum[kSides] = {};
    for (int i = 0; i < kBoxTokens; ++i) {
      const float w = block[Layout::kTokenIn + h * kBoxTokens + i];
      for (int side = 0; side < kSides; ++side) sum[side] += u.of[side][i] * w;
    }
    for (int side = 0; side < kSides; ++side) {
      const Four biased = sum[side] + block[Layout::kTokenInBias + h];
      Gelu(biased, &hidden[h][side], &unused);
    }
  }
  for (int i = 0; i < kBoxTokens; ++i) {
    Four sum[kSides] = {};
    for (int h = 0; h < kHidden; ++h) {
      const float w = block[Layout::kTokenOut + i * kHidden + h];
      for (int side = 0; side < kSides; ++side) sum[side] += hidden[h][side] * w;
    }
    for (int side = 0; side < kSides; ++side) {
      x->of[side][i] += sum[side] + block[Layout::kTokenOutBias + i];
    }
  }
}

void MixChannels(const State& u, const float* block, State* x) {
  constexpr int kHidden = Layout::kChannelHidden;
  for (int side = 0; side < kSides; ++side) {
    Four hidden[kHidden], unused;  // A lane is a token.
    for (int h = 0; h < kHidden; ++h) {
      const Four w = Load(block + Layout::kChannelIn + 4 * h);
      Four sum = Four{} + block[Layout::kChannelInBias + h];
      for (int i = 0; i < kBoxTokens; ++i) sum[i] += SumInAll(u.of[side][i] * w)[0];
      Gelu(sum, &hidden[h], &unused);
    }
    const float* out = block + Layout::kChannelOut;
    const Four first = {out[0], out[2], out[4], out[6]}, second = {out[1], out[3], out[5], out[7]};
    for (int i = 0; i < kBoxTokens; ++i) {
      x->of[side][i] +=
          Load(block + Layout::kChannelOutBias) + first * hidden[0][i] + second * hidden[1][i];
    }
  }
}

std::array<std::array<float, 2>, 2> EvaluateFour(const float* p, int n_outputs,
                                                 const BoxTokens& left, const BoxTokens& right) {
  State x, u;
  const Four embedding = Load(p + Layout::kEmbedding), bias = Load(p + Layout::kEmbeddingBias);
  for (std::size_t i = 0; i < kBoxTokens; ++i) {
    x.of[0][i] = embedding * left[i] + bias;
    x.of[1][i] = embedding * right[i] + bias;
  }
  for (int b = 0; b < Layout::kBlocks; ++b) {
    const float* block = p + Layout::Block(b);
    Normalise(x, block + Layout::kTokenNorm, &u);
    MixTokens(u, block, &x);
    Normalise(x, block + Layout::kChannelNorm, &u);
    MixChannels(u, block, &x);
  }
  Normalise(x, p + Layout::kLastNorm, &u);
  std::array<std::array<float, 2>, 2> result{};
  for (int side = 0; side < kSides; ++side) {
    const Four* of = u.of[side];
    const Four mean = (of[0] + of[1] + of[2] + of[3]) * 0.25f;
    for (int k = 0; k < n_outputs; ++k) {
      Four out = SumInAll(mean * Load(p + Layout::kHead + 4 * k));
      out += p[Layout::HeadBias(n_outputs) + k];
      if (n_outputs == 1) Tanh(out, &out);
      result[side][k] = out[0];
    }
  }
  return result;
}

// -------------------------------------------------------------------------------------------------

[[noreturn]] void RefuseWidth(int width) {
  throw std::invalid_argument(fmt::format("a mixer is 4 or 96 wide, not {}", width));
}

}  // namespace

int MixerParameters(int width, int n_outputs) {
  if (width == 4) return MixerLayout<4>::Parameters(n_outputs);
  if (width == 96) return MixerLayout<96>::Parameters(n_outputs);
  RefuseWidth(width);
}

double MixerOperations(int width, int n_outputs) {
  MixerParameters(width, n_outputs);
  const double tokens = kBoxTokens, hidden = MixerLayout<4>::kTokenHidden;
  const double blocks = MixerLayout<4>::kBlocks;
  const double mlps = blocks * (2 * width * tokens * hidden + 2 * tokens * width * (width / 2));
  const double norms = (2 * blocks + 1) * 5 * tokens * width;
  return tokens * width + mlps + norms + width * n_outputs;
}

Mixer::Mixer(int width, int n_outputs, std::vector<float> parameters)
    : width_(width), n_outputs_(n_outputs), parameters_(std::move(parameters)) {
  const auto wanted = static_cast<std::size_t>(MixerParameters(width, n_outputs));
  if (parameters_.size() != wanted) {
    throw std::invalid_argument(
        fmt::format("must be {} numbers (found {})", wanted, parameters_.size()));
  }
}

std::array<std::array<float, 2>, 2> Mixer::Evaluate(const BoxTokens& left,
                                                    const BoxTokens& right) const {
  const float* p = parameters_.data();
  if (width_ == 4) return EvaluateFour(p, n_outputs_, left, right);
  return n_outputs_ == 1 ? EvaluateAs<96, 1>(p, left, right) : EvaluateAs<96, 2>(p, left, right);
}

}  // namespace windhover
