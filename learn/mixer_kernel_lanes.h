#pragma once

#include <cstring>

#include "estimator/mixer_pass.h"
#include "learn/mixer_kernel.h"

namespace windhover {

/// A MixerKernel of passes over kLanes boxes. One file makes those of one number of lanes, with
/// the instructions that fit them.
template <int kLanes, int kWidth, int kOutputs>
class MixerKernelLanes final : public MixerKernel {
 public:
  void Forward(const float* parameters, const Tokens& x, Outputs* out) override {
    for (int part = 0; part < kParts; ++part) {
      typename Pass::Tokens lanes;
      for (std::size_t i = 0; i < kBoxTokens; ++i) {
        std::memcpy(&lanes[i], x[i].data() + part * kLanes, sizeof lanes[i]);
      }
      typename Pass::Outputs answer;
      passes_[part].Forward(parameters, lanes, &answer);
      for (std::size_t k = 0; k < kOutputs; ++k) {
        std::memcpy((*out)[k].data() + part * kLanes, &answer[k], sizeof answer[k]);
      }
    }
  }

  void Backward(const float* parameters, const Outputs& d_out) override {
    for (int part = 0; part < kParts; ++part) {
      typename Pass::Outputs lanes;
      for (std::size_t k = 0; k < kOutputs; ++k) {
        std::memcpy(&lanes[k], d_out[k].data() + part * kLanes, sizeof lanes[k]);
      }
      passes_[part].Backward(parameters, lanes, gradient_[part]);
    }
  }

  // Halves are added to halves, whatever the number of lanes.
  void TakeGradient(std::vector<float>* gradient) override {
    gradient->resize(kParameters);
    for (int i = 0; i < kParameters; ++i) {
      float sums[kBoxes];
      for (int part = 0; part < kParts; ++part) {
        std::memcpy(sums + part * kLanes, &gradient_[part][i], sizeof gradient_[part][i]);
        gradient_[part][i] = Vector{};
      }
      for (int half = kBoxes / 2; half > 0; half /= 2) {
        for (int k = 0; k < half; ++k) sums[k] += sums[k + half];
      }
      (*gradient)[static_cast<std::size_t>(i)] = sums[0];
    }
  }

 private:
  static constexpr int kParts = kBoxes / kLanes;
  static constexpr int kParameters = MixerLayout<kWidth>::Parameters(kOutputs);
  using Vector = typename FloatLanes<kLanes>::Type;
  using Pass = MixerPass<kWidth, kOutputs, Vector, /*kTraining=*/true>;

  Pass passes_[kParts];
  Vector gradient_[kParts][kParameters] = {};
};

template <int kLanes>
std::unique_ptr<MixerKernel> MakeMixerKernelLanes(int width, int n_outputs) {
  if (width == 4 && n_outputs == 1) return std::make_unique<MixerKernelLanes<kLanes, 4, 1>>();
  if (width == 4) return std::make_unique<MixerKernelLanes<kLanes, 4, 2>>();
  if (n_outputs == 1) return std::make_unique<MixerKernelLanes<kLanes, 96, 1>>();
  return std::make_unique<MixerKernelLanes<kLanes, 96, 2>>();
}

// Each in the file of its name.
std::unique_ptr<MixerKernel> MakeMixerKernelSse2(int width, int n_outputs);
std::unique_ptr<MixerKernel> MakeMixerKernelAvx2(int width, int n_outputs);
std::unique_ptr<MixerKernel> MakeMixerKernelAvx512(int width, int n_outputs);

}  // namespace windhover
