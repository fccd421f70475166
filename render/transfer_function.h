#pragma once

#include <array>
#include <cstdint>

#include "common/cpu/instruction_set.h"
#include "scenarios/sensor_config.h"

namespace windhover {

/// From linear light to the bytes of an image.
///
/// A cubic in each half octave of light, true to 0.02 grey levels before rounding. It is worked
/// out where sixteen values are done at once, else looked up: the same bits.
class TransferFunction {
 public:
  explicit TransferFunction(TransferCurve curve);

  /// `bytes` of `count` values of light, 65535 is white; light is known to 8/65535.
  void Apply(const std::uint16_t* linear, int count, std::uint8_t* bytes,
             InstructionSet isa = WidestInstructionSet()) const;

 private:
  void ApplyAvx512(const std::uint16_t* linear, int count, std::uint8_t* bytes) const;
  std::uint8_t ByteOf(int step) const;

  static constexpr int kSteps = 8192, kPieces = 32;
  std::array<std::array<float, kPieces>, 4> coefficients_{};  ///< [power][piece]
  std::array<std::uint8_t, kSteps> table_;
};

/// The light, 0 to 1, that `curve` makes `value`, 0 to 1, of.
double LightOf(TransferCurve curve, double value);

}  // namespace windhover
