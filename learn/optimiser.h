#pragma once

#include <vector>

namespace windhover {

enum class OptimiserKind { kSgd, kAdamW };

struct OptimiserConfig {
  OptimiserKind kind = OptimiserKind::kSgd;
  double rate = 1e-3;          ///< The largest of the schedule.
  double momentum = 0.9;       ///< Of SGD; beta1 of AdamW, whose beta2 is 0.999.
  double weight_decay = 1e-3;  ///< Part of the gradient (SGD) or decoupled (AdamW).
  double clip = 1.0;           ///< Largest norm of a gradient; 0: any.
};

/// Follows gradients: SGD as torch.optim has it, or AdamW (I. Loshchilov & F. Hutter, "Decoupled
/// Weight Decay Regularization", arXiv 1711.05101).
class Optimiser {
 public:
  Optimiser(const OptimiserConfig& config, std::size_t n_parameters);

  /// One step at `rate`. @return whether the gradient was finite; if not, nothing changes.
  bool Step(double rate, const std::vector<float>& gradient, std::vector<float>* parameters);

  /// All that it remembers.
  struct Memory {
    std::vector<float> first, second;  ///< `second` of AdamW only.
    int steps = 0;
  };
  const Memory& memory() const { return memory_; }
  void Restore(Memory memory) { memory_ = std::move(memory); }

 private:
  OptimiserConfig config_;
  Memory memory_;
};

/// Share of the largest rate at `epoch`: linear warm-up, then half a cosine down to 0.
double RateShare(int epoch, int n_epochs, int n_warm_up);

}  // namespace windhover
