#pragma once

#include <array>
#include <type_traits>

#include "estimator/float_lanes.h"

namespace windhover {

/// What a mixer sees of a box: angle around the image's centre, distance from it, width, height.
inline constexpr int kBoxTokens = 4;

/// Where the parameters of a two-layer MLP-Mixer over kBoxTokens tokens stand in one array: the
/// embedding (weight, bias), then for each block its first norm, token MLP (16 hidden), second
/// norm and channel MLP (kWidth / 2 hidden), then the last norm and the head. Matrices are stored
/// output by output, as in torch's Linear. Width 4 is the authors' code: 393 parameters with one
/// output (PCM), 398 with two (gate). Width 96 has the 0.02 M of the paper's table IV.
/// Source: I. Tolstikhin et al., "MLP-Mixer", arXiv 2105.01601; sizes: the authors' code.
template <int kWidth>
struct MixerLayout {
  static constexpr int kBlocks = 2, kTokenHidden = 16, kChannelHidden = kWidth / 2;
  static constexpr int kEmbedding = 0, kEmbeddingBias = kWidth;

  static constexpr int kTokenMlp = kTokenHidden * (2 * kBoxTokens + 1) + kBoxTokens;
  static constexpr int kChannelMlp = kChannelHidden * (2 * kWidth + 1) + kWidth;
  static constexpr int kBlock = 4 * kWidth + kTokenMlp + kChannelMlp;

  // Within a block.
  static constexpr int kTokenNorm = 0, kTokenIn = 2 * kWidth;
  static constexpr int kTokenInBias = kTokenIn + kTokenHidden * kBoxTokens;
  static constexpr int kTokenOut = kTokenInBias + kTokenHidden;
  static constexpr int kTokenOutBias = kTokenOut + kBoxTokens * kTokenHidden;
  static constexpr int kChannelNorm = kTokenIn + kTokenMlp;
  static constexpr int kChannelIn = kChannelNorm + 2 * kWidth;
  static constexpr int kChannelInBias = kChannelIn + kChannelHidden * kWidth;
  static constexpr int kChannelOut = kChannelInBias + kChannelHidden;
  static constexpr int kChannelOutBias = kChannelOut + kWidth * kChannelHidden;

  static constexpr int Block(int block) { return 2 * kWidth + block * kBlock; }
  static constexpr int kLastNorm = Block(kBlocks);
  static constexpr int kHead = kLastNorm + 2 * kWidth;
  static constexpr int HeadBias(int n_outputs) { return kHead + n_outputs * kWidth; }
  static constexpr int Parameters(int n_outputs) { return HeadBias(n_outputs) + n_outputs; }
};

/// One pass of a mixer forward and, if kTraining, back. `Vector` is as many boxes as there are
/// lanes, each on its own; a single double is one box in full precision. Parameters are scalars
/// of the same precision.
template <int kWidth, int kOutputs, typename Vector, bool kTraining>
class MixerPass {
 public:
  using Layout = MixerLayout<kWidth>;
  using Scalar = std::conditional_t<std::is_same_v<Vector, double>, double, float>;
  using Tokens = std::array<Vector, kBoxTokens>;
  using Outputs = std::array<Vector, kOutputs>;

  /// One output goes through tanh, so that an offset is below the width of an image; two are the
  /// logits of a gate.
  void Forward(const Scalar* p, const Tokens& x, Outputs* out) {
    x_ = x;
    for (int i = 0; i < kBoxTokens; ++i) {
      for (int c = 0; c < kWidth; ++c) {
        state_[i][c] = x[i] * p[Layout::kEmbedding + c] + p[Layout::kEmbeddingBias + c];
      }
    }
    for (int b = 0; b < Layout::kBlocks; ++b) {
      const Scalar* block = p + Layout::Block(b);
      Kept& kept = kept_[kTraining ? b : 0];
      Normalise(block + Layout::kTokenNorm, &kept.token_norm);
      MixTokens(block, &kept);
      Normalise(block + Layout::kChannelNorm, &kept.channel_norm);
      MixChannels(block, &kept);
    }
    Normalise(p + Layout::kLastNorm, &last_norm_);
    for (int c = 0; c < kWidth; ++c) {
      mean_[c] = Zero();
      for (int i = 0; i < kBoxTokens; ++i) mean_[c] += last_norm_.scaled[i][c];
      mean_[c] *= Scalar{1} / kBoxTokens;
    }
    for (int k = 0; k < kOutputs; ++k) {
      Vector sum = Zero() + p[Layout::HeadBias(kOutputs) + k];
      for (int c = 0; c < kWidth; ++c) sum += mean_[c] * p[Layout::kHead + k * kWidth + c];
      if (kOutputs == 1) Tanh(sum, &sum);
      out_[k] = sum;
    }
    *out = out_;
  }

  /// Adds the derivative of a loss by each parameter to `g`, lane by lane, given that by each
  /// output. @pre kTraining, and Forward() was the last call.
  void Backward(const Scalar* p, const Outputs& d_out, Vector* g) {
    static_assert(kTraining);
    Vector d_mean[kWidth] = {};
    for (int k = 0; k < kOutputs; ++k) {
      Vector d = d_out[k];
      if (kOutputs == 1) d *= Scalar{1} - out_[k] * out_[k];
      g[Layout::HeadBias(kOutputs) + k] += d;
      for (int c = 0; c < kWidth; ++c) {
        g[Layout::kHead + k * kWidth + c] += d * mean_[c];
        d_mean[c] += d * p[Layout::kHead + k * kWidth + c];
      }
    }
    for (int i = 0; i < kBoxTokens; ++i) {
      for (int c = 0; c < kWidth; ++c) {
        d_scaled_[i][c] = d_mean[c] * (Scalar{1} / kBoxTokens);
        d_state_[i][c] = Zero();
      }
    }
    NormaliseBack(p + Layout::kLastNorm, last_norm_, g + Layout::kLastNorm);
    for (int b = Layout::kBlocks - 1; b >= 0; --b) {
      const Scalar* block = p + Layout::Block(b);
      Vector* g_block = g + Layout::Block(b);
      MixChannelsBack(block, kept_[b], g_block);
      NormaliseBack(block + Layout::kChannelNorm, kept_[b].channel_norm,
                    g_block + Layout::kChannelNorm);
      MixTokensBack(block, kept_[b], g_block);
      NormaliseBack(block + Layout::kTokenNorm, kept_[b].token_norm, g_block + Layout::kTokenNorm);
    }
    for (int i = 0; i < kBoxTokens; ++i) {
      for (int c = 0; c < kWidth; ++c) {
        g[Layout::kEmbedding + c] += d_state_[i][c] * x_[i];
        g[Layout::kEmbeddingBias + c] += d_state_[i][c];
      }
    }
  }

 private:
  using Grid = Vector[kBoxTokens][kWidth];
  static constexpr int kTokenHidden = Layout::kTokenHidden;
  static constexpr int kChannelHidden = Layout::kChannelHidden;

  struct Norm {
    Grid unit, scaled;  ///< With mean 0 and variance 1; then with weight and bias.
    Vector inverse_sigma[kBoxTokens];
  };
  struct Kept {
    Norm token_norm, channel_norm;
    Vector token[kWidth][kTokenHidden], token_slope[kWidth][kTokenHidden];
    Vector channel[kBoxTokens][kChannelHidden], channel_slope[kBoxTokens][kChannelHidden];
  };

  static Vector Zero() { return Vector{}; }

  // Layer norm over the channels of each token.
  void Normalise(const Scalar* p, Norm* norm) {
    constexpr Scalar kEpsilon = Scalar(1e-5), kShare = Scalar{1} / kWidth;
    for (int i = 0; i < kBoxTokens; ++i) {
      Vector mean = Zero(), variance = Zero();
      for (int c = 0; c < kWidth; ++c) mean += state_[i][c];
      mean *= kShare;
      for (int c = 0; c < kWidth; ++c) {
        const Vector off = state_[i][c] - mean;
        variance += off * off;
      }
      const Vector held = variance * kShare + kEpsilon;
      InverseSqrt(held, &norm->inverse_sigma[i]);
      for (int c = 0; c < kWidth; ++c) {
        norm->unit[i][c] = (state_[i][c] - mean) * norm->inverse_sigma[i];
        norm->scaled[i][c] = norm->unit[i][c] * p[c] + p[kWidth + c];
      }
    }
  }

  // From d_scaled_ onto d_state_.
  void NormaliseBack(const Scalar* p, const Norm& norm, Vector* g) {
    constexpr Scalar kShare = Scalar{1} / kWidth;
    for (int i = 0; i < kBoxTokens; ++i) {
      Vector mean = Zero(), along = Zero();
      for (int c = 0; c < kWidth; ++c) {
        g[c] += d_scaled_[i][c] * norm.unit[i][c];
        g[kWidth + c] += d_scaled_[i][c];
        d_scaled_[i][c] *= p[c];
        mean += d_scaled_[i][c];
        along += d_scaled_[i][c] * norm.unit[i][c];
      }
      mean *= kShare;
      along *= kShare;
      for (int c = 0; c < kWidth; ++c) {
        d_state_[i][c] +=
            (d_scaled_[i][c] - mean - norm.unit[i][c] * along) * norm.inverse_sigma[i];
      }
    }
  }

  void MixTokens(const Scalar* p, Kept* kept) {
    const auto& u = kept->token_norm.scaled;
    for (int c = 0; c < kWidth; ++c) {
      for (int h = 0; h < kTokenHidden; ++h) {
        Vector sum = Zero() + p[Layout::kTokenInBias + h];
        for (int i = 0; i < kBoxTokens; ++i) {
          sum += u[i][c] * p[Layout::kTokenIn + h * kBoxTokens + i];
        }
        Gelu(sum, &kept->token[c][h], &kept->token_slope[c][h]);
      }
      for (int i = 0; i < kBoxTokens; ++i) {
        Vector sum = Zero() + p[Layout::kTokenOutBias + i];
        for (int h = 0; h < kTokenHidden; ++h) {
          sum += kept->token[c][h] * p[Layout::kTokenOut + i * kTokenHidden + h];
        }
        state_[i][c] += sum;
      }
    }
  }

  // From d_state_ to d_scaled_.
  void MixTokensBack(const Scalar* p, const Kept& kept, Vector* g) {
    const auto& u = kept.token_norm.scaled;
    for (int c = 0; c < kWidth; ++c) {
      Vector d_hidden[kTokenHidden] = {}, d_in[kBoxTokens] = {};
      for (int i = 0; i < kBoxTokens; ++i) {
        const Vector d = d_state_[i][c];
        g[Layout::kTokenOutBias + i] += d;
        for (int h = 0; h < kTokenHidden; ++h) {
          g[Layout::kTokenOut + i * kTokenHidden + h] += d * kept.token[c][h];
          d_hidden[h] += d * p[Layout::kTokenOut + i * kTokenHidden + h];
        }
      }
      for (int h = 0; h < kTokenHidden; ++h) {
        const Vector d = d_hidden[h] * kept.token_slope[c][h];
        g[Layout::kTokenInBias + h] += d;
        for (int i = 0; i < kBoxTokens; ++i) {
          g[Layout::kTokenIn + h * kBoxTokens + i] += d * u[i][c];
          d_in[i] += d * p[Layout::kTokenIn + h * kBoxTokens + i];
        }
      }
      for (int i = 0; i < kBoxTokens; ++i) d_scaled_[i][c] = d_in[i];
    }
  }

  void MixChannels(const Scalar* p, Kept* kept) {
    const auto& u = kept->channel_norm.scaled;
    for (int i = 0; i < kBoxTokens; ++i) {
      for (int h = 0; h < kChannelHidden; ++h) {
        Vector sum = Zero() + p[Layout::kChannelInBias + h];
        for (int c = 0; c < kWidth; ++c) sum += u[i][c] * p[Layout::kChannelIn + h * kWidth + c];
        Gelu(sum, &kept->channel[i][h], &kept->channel_slope[i][h]);
      }
      for (int c = 0; c < kWidth; ++c) {
        Vector sum = Zero() + p[Layout::kChannelOutBias + c];
        for (int h = 0; h < kChannelHidden; ++h) {
          sum += kept->channel[i][h] * p[Layout::kChannelOut + c * kChannelHidden + h];
        }
        state_[i][c] += sum;
      }
    }
  }

  // From d_state_ to d_scaled_.
  void MixChannelsBack(const Scalar* p, const Kept& kept, Vector* g) {
    const auto& u = kept.channel_norm.scaled;
    for (int i = 0; i < kBoxTokens; ++i) {
      Vector d_hidden[kChannelHidden] = {};
      for (int c = 0; c < kWidth; ++c) {
        const Vector d = d_state_[i][c];
        g[Layout::kChannelOutBias + c] += d;
        for (int h = 0; h < kChannelHidden; ++h) {
          g[Layout::kChannelOut + c * kChannelHidden + h] += d * kept.channel[i][h];
          d_hidden[h] += d * p[Layout::kChannelOut + c * kChannelHidden + h];
        }
        d_scaled_[i][c] = Zero();
      }
      for (int h = 0; h < kChannelHidden; ++h) {
        const Vector d = d_hidden[h] * kept.channel_slope[i][h];
        g[Layout::kChannelInBias + h] += d;
        for (int c = 0; c < kWidth; ++c) {
          g[Layout::kChannelIn + h * kWidth + c] += d * u[i][c];
          d_scaled_[i][c] += d * p[Layout::kChannelIn + h * kWidth + c];
        }
      }
    }
  }

  Tokens x_;
  Grid state_, d_state_, d_scaled_;
  Kept kept_[kTraining ? Layout::kBlocks : 1];
  Norm last_norm_;
  Vector mean_[kWidth];
  Outputs out_;
};

}  // namespace windhover
