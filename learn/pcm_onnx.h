#pragma once

#include <string>
#include <vector>

#include "estimator/pcm.h"

namespace windhover {

/// A network as an ONNX model (learn/onnx_writer.h): from `tokens` [2, 4], the 4-tuples
/// {theta, r, w, h} of the left and the right box, to `offsets` [2, 1] (in image widths) or, of a
/// gate, to `logits` [2, 2] (easy, hard; before they are averaged over both boxes). The
/// initializers are the parameters, matrices input by input; layer norms and GELU, x Φ(x), are
/// written out in operators that opset 11 has.
std::string MixerOnnx(const Mixer& mixer);

struct NamedModel {
  std::string name;   ///< `offset0`, `gate0`, `offset1`, …, `alone`, as in the card.
  std::string model;  ///< Content of an .onnx file.
};

/// All networks of a card's position corrections.
std::vector<NamedModel> PcmOnnx(const PcmStages& stages);

}  // namespace windhover
