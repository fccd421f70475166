#pragma once

#include "estimator/mixer_four.h"
#include "estimator/mixer_pass.h"

namespace windhover {

/// One pass of a mixer of width 4 over both boxes; a vector is the four channels of a token of
/// `kBoxes` boxes, so that no lane is empty. One file makes those of one number of lanes, with
/// the instructions that fit them; every one does the same in the same order.
template <int kBoxes>
class MixerFourLanes {
 public:
  static void Evaluate(const float* p, int n_outputs, const BoxTokens& left, const BoxTokens& right,
                       MixerAnswers* answers) {
    const float* tokens[2] = {&left[0], &right[0]};
    for (int part = 0; part < kParts; ++part) {
      Grid x, u;
      const Lanes embedding = Load(p + Layout::kEmbedding), bias = Load(p + Layout::kEmbeddingBias);
      for (int i = 0; i < kBoxTokens; ++i) x[i] = embedding * Of(tokens + part, i) + bias;
      for (int b = 0; b < Layout::kBlocks; ++b) {
        const float* block = p + Layout::Block(b);
        Normalise(x, block + Layout::kTokenNorm, u);
        MixTokens(u, block, x);
        Normalise(x, block + Layout::kChannelNorm, u);
        MixChannels(u, block, x);
      }
      Normalise(x, p + Layout::kLastNorm, u);
      const Lanes mean = (u[0] + u[1] + u[2] + u[3]) * 0.25f;
      for (int k = 0; k < n_outputs; ++k) {
        Lanes out = SumInAll(mean * Load(p + Layout::kHead + 4 * k));
        out += p[Layout::HeadBias(n_outputs) + k];
        if (n_outputs == 1) Tanh(out, &out);
        for (int box = 0; box < kBoxes; ++box)
          (&(*answers)[0][0])[2 * (part + box) + k] = out[4 * box];
      }
    }
  }

 private:
  static constexpr int kParts = 2 / kBoxes;
  using Lanes = typename FloatLanes<4 * kBoxes>::Type;
  using Grid = Lanes[kBoxTokens];
  using Layout = MixerLayout<4>;

  static Lanes Load(const float* from) {
    Lanes lanes;
    for (int box = 0; box < kBoxes; ++box) {
      __builtin_memcpy(reinterpret_cast<float*>(&lanes) + 4 * box, from, 4 * sizeof *from);
    }
    return lanes;
  }

  /// Token `i` of each box, in all of its lanes.
  static Lanes Of(const float* const* tokens, int i) {
    Lanes lanes;
    for (int lane = 0; lane < 4 * kBoxes; ++lane) lanes[lane] = tokens[lane / 4][i];
    return lanes;
  }

  static Lanes SumInAll(const Lanes& v) {
    if constexpr (kBoxes == 1) {
      const Lanes pairs = v + __builtin_shufflevector(v, v, 1, 0, 3, 2);
      return pairs + __builtin_shufflevector(pairs, pairs, 2, 3, 0, 1);
    } else {
      const Lanes pairs = v + __builtin_shufflevector(v, v, 1, 0, 3, 2, 5, 4, 7, 6);
      return pairs + __builtin_shufflevector(pairs, pairs, 2, 3, 0, 1, 6, 7, 4, 5);
    }
  }

  /// Lane `kLane` of each box, in all of its lanes.
  template <int kLane>
  static Lanes Spread(const Lanes& v) {
    if constexpr (kBoxes == 1) {
      return __builtin_shufflevector(v, v, kLane, kLane, kLane, kLane);
    } else {
      constexpr int kNext = kLane + 4;
      return __builtin_shufflevector(v, v, kLane, kLane, kLane, kLane, kNext, kNext, kNext, kNext);
    }
  }

  /// Lane i of each box of `of[i]`.
  static Lanes Gather(const Lanes (&of)[4]) {
    if constexpr (kBoxes == 1) {
      const Lanes low = __builtin_shufflevector(of[0], of[1], 0, 5, 2, 7);
      const Lanes high = __builtin_shufflevector(of[2], of[3], 0, 5, 2, 7);
      return __builtin_shufflevector(low, high, 0, 1, 6, 7);
    } else {
      const Lanes low = __builtin_shufflevector(of[0], of[1], 0, 9, 2, 11, 4, 13, 6, 15);
      const Lanes high = __builtin_shufflevector(of[2], of[3], 0, 9, 2, 11, 4, 13, 6, 15);
      return __builtin_shufflevector(low, high, 0, 1, 10, 11, 4, 5, 14, 15);
    }
  }

  static void Normalise(const Grid& x, const float* p, Grid& u) {
    const Lanes weight = Load(p), bias = Load(p + 4);
    for (int i = 0; i < kBoxTokens; ++i) {
      const Lanes off = x[i] - SumInAll(x[i]) * 0.25f;
      const Lanes variance = SumInAll(off * off) * 0.25f + 1e-5f;
      Lanes inverse_sigma;
      InverseSqrt(variance, &inverse_sigma);
      u[i] = off * inverse_sigma * weight + bias;
    }
  }

  static void MixTokens(const Grid& u, const float* block, Grid& x) {
    constexpr int kHidden = Layout::kTokenHidden;
    Lanes hidden[kHidden], unused;
    for (int h = 0; h < kHidden; ++h) {
      Lanes sum = {};
      for (int i = 0; i < kBoxTokens; ++i) {
        sum += u[i] * block[Layout::kTokenIn + h * kBoxTokens + i];
      }
      sum += block[Layout::kTokenInBias + h];
      Gelu(sum, &hidden[h], &unused);
    }
    for (int i = 0; i < kBoxTokens; ++i) {
      Lanes sum = {};
      for (int h = 0; h < kHidden; ++h) {
        sum += hidden[h] * block[Layout::kTokenOut + i * kHidden + h];
      }
      x[i] += sum + block[Layout::kTokenOutBias + i];
    }
  }

  static void MixChannels(const Grid& u, const float* block, Grid& x) {
    constexpr int kHidden = Layout::kChannelHidden;
    Lanes hidden[kHidden], unused;  // A lane is a token.
    for (int h = 0; h < kHidden; ++h) {
      const Lanes w = Load(block + Layout::kChannelIn + 4 * h);
      const Lanes sums[4] = {SumInAll(u[0] * w), SumInAll(u[1] * w), SumInAll(u[2] * w),
                             SumInAll(u[3] * w)};
      Gelu(Gather(sums) + block[Layout::kChannelInBias + h], &hidden[h], &unused);
    }
    const float* out = block + Layout::kChannelOut;
    const float columns[2][4] = {{out[0], out[2], out[4], out[6]},
                                 {out[1], out[3], out[5], out[7]}};
    const Lanes first = Load(columns[0]), second = Load(columns[1]);
    const Lanes bias = Load(block + Layout::kChannelOutBias);
    x[0] += bias + first * Spread<0>(hidden[0]) + second * Spread<0>(hidden[1]);
    x[1] += bias + first * Spread<1>(hidden[0]) + second * Spread<1>(hidden[1]);
    x[2] += bias + first * Spread<2>(hidden[0]) + second * Spread<2>(hidden[1]);
    x[3] += bias + first * Spread<3>(hidden[0]) + second * Spread<3>(hidden[1]);
  }
};

}  // namespace windhover
