#pragma once

#include <array>
#include <span>
#include <vector>

namespace windhover {

/// {theta, r, w, h} of a box, the 4-tuple of the paper's section IV-A: angle and distance from the
/// image's centre, in turns and half diagonals; width and height in image widths and heights.
using BoxTokens = std::array<float, 4>;

/// Widths that a mixer may have: that of the authors' code, and that of the paper's table.
inline constexpr std::array kMixerWidths = {4, 96};

/// Number of parameters of a mixer (estimator/mixer_pass.h).
/// @throws std::invalid_argument unless `width` is one of kMixerWidths.
int MixerParameters(int width, int n_outputs);

/// What a mixer's answer costs, in the convention of the paper's table (multiply-adds count one,
/// a layer norm five a number): 1572 for a box at width 4.
double MixerOperations(int width, int n_outputs);

/// A two-layer MLP-Mixer that maps the 4-tuple of a box to an offset (one output, through tanh) or
/// to the logits of a gate (two). Both cameras go through the same weights.
class Mixer {
 public:
  /// @throws std::invalid_argument unless there are MixerParameters() parameters.
  Mixer(int width, int n_outputs, std::vector<float> parameters);

  /// The outputs for the left box, then those for the right one; the second is 0 if there is one.
  std::array<std::array<float, 2>, 2> Evaluate(const BoxTokens& left, const BoxTokens& right) const;

  int width() const { return width_; }
  int n_outputs() const { return n_outputs_; }
  const std::vector<float>& parameters() const { return parameters_; }

 private:
  int width_, n_outputs_;
  std::vector<float> parameters_;
};

}  // namespace windhover
