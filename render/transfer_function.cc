#include "render/transfer_function.h"

#include <bit>
#include <cmath>
#include <numbers>

#include <immintrin.h>

#include "common/image/srgb.h"

namespace windhover {
namespace {

constexpr int kStepShift = 3;
// A float's exponent and first bit of its mantissa name its half octave; steps begin at 0.5.
constexpr int kPieceShift = 22;

// Pieces are numbered from an arbitrary one on, in a circle, as a permutation takes its index.
std::int32_t PieceOf(float x) { return (std::bit_cast<std::int32_t>(x) >> kPieceShift) & 31; }

double ValueOf(TransferCurve curve, double light) {
  switch (curve) {
    case TransferCurve::kSrgb:
      return SrgbFromLinear(light);
    case TransferCurve::kGamma22:
      return std::pow(light, 1 / 2.2);
    case TransferCurve::kLinear:
      break;
  }
  return light;
}

// The cubic through four Chebyshev nodes of [low, high].
template <typename Function>
std::array<double, 4> CubicThrough(double low, double high, const Function& f) {
  std::array<double, 4> x{}, divided{};
  for (std::size_t i = 0; i < 4; ++i) {
    const double node = std::cos(std::numbers::pi * (2 * static_cast<double>(i) + 1) / 8);
    x[i] = (low + high) / 2 + (high - low) / 2 * node;
    divided[i] = f(x[i]);
  }
  for (std::size_t order = 1; order < 4; ++order) {
    for (std::size_t i = 3; i >= order; --i) {
      divided[i] = (divided[i] - divided[i - 1]) / (x[i] - x[i - order]);
    }
  }
  // From Newton's form to powers of x.
  std::array<double, 4> powers{};
  for (std::size_t i = 4; i-- > 0;) {
    for (std::size_t k = 3; k > 0; --k) powers[k] = powers[k - 1] - x[i] * powers[k];
    powers[0] = divided[i] - x[i] * powers[0];
  }
  return powers;
}

}  // namespace

double LightOf(TransferCurve curve, double value) {
  switch (curve) {
    case TransferCurve::kSrgb:
      return LinearFromSrgb(value);
    case TransferCurve::kGamma22:
      return std::pow(value, 2.2);
    case TransferCurve::kLinear:
      break;
  }
  return value;
}

TransferFunction::TransferFunction(TransferCurve curve) {
  const auto byte_of = [curve](double steps) {
    return 255 * ValueOf(curve, std::fmin(steps / kSteps, 1)) + 0.5;
  };
  // The first half octave holds step 0 alone: black stays black.
  float start = 0.75f;
  for (int i = 1; i < kPieces; ++i) {
    const float end = std::bit_cast<float>(std::bit_cast<std::int32_t>(start) + (1 << kPieceShift));
    const std::array<double, 4> cubic = CubicThrough(start, end, byte_of);
    for (std::size_t power = 0; power < 4; ++power) {
      coefficients_[power][static_cast<std::size_t>(PieceOf(start))] =
          static_cast<float>(cubic[power]);
    }
    start = end;
  }
  for (int step = 0; step < kSteps; ++step) table_[static_cast<std::size_t>(step)] = ByteOf(step);
}

std::uint8_t TransferFunction::ByteOf(int step) const {
  const float x = static_cast<float>(step) + 0.5f;
  const auto piece = static_cast<std::size_t>(PieceOf(x));
  const auto& c = coefficients_;
  const float y = c[0][piece] + x * (c[1][piece] + x * (c[2][piece] + x * c[3][piece]));
  return static_cast<std::uint8_t>(static_cast<std::int32_t>(y));
}

__attribute__((target("avx512f,avx512bw,avx512vl"))) void TransferFunction::ApplyAvx512(
    const std::uint16_t* linear, int count, std::uint8_t* bytes) const {
  __m512 low[4], high[4];
  for (std::size_t power = 0; power < 4; ++power) {
    low[power] = _mm512_loadu_ps(coefficients_[power].data());
    high[power] = _mm512_loadu_ps(coefficients_[power].data() + 16);
  }
  const auto byte_of = [&](__m256i light) __attribute__((target("avx512f,avx512bw,avx512vl"))) {
    const __m512i step = _mm512_cvtepu16_epi32(_mm256_srli_epi16(light, kStepShift));
    const __m512 x = _mm512_add_ps(_mm512_cvtepi32_ps(step), _mm512_set1_ps(0.5f));
    const __m512i piece = _mm512_srli_epi32(_mm512_castps_si512(x), kPieceShift);
    __m512 y = _mm512_permutex2var_ps(low[3], piece, high[3]);
    for (std::size_t power = 3; power-- > 0;) {
      y = _mm512_add_ps(_mm512_permutex2var_ps(low[power], piece, high[power]),
                        _mm512_mul_ps(x, y));
    }
    return _mm512_cvtepi32_epi8(_mm512_cvttps_epi32(y));
  };
  int i = 0;
  for (; i + 16 <= count; i += 16) {
    _mm_storeu_epi8(bytes + i, byte_of(_mm256_loadu_epi16(linear + i)));
  }
  if (i == count) return;
  const auto present = static_cast<__mmask16>((1u << (count - i)) - 1);
  _mm_mask_storeu_epi8(bytes + i, present, byte_of(_mm256_maskz_loadu_epi16(present, linear + i)));
}

void TransferFunction::Apply(const std::uint16_t* linear, int count, std::uint8_t* bytes,
                             InstructionSet isa) const {
  if (isa == InstructionSet::kAvx512) return ApplyAvx512(linear, count, bytes);
  for (int i = 0; i < count; ++i) bytes[i] = table_[linear[i] >> kStepShift];
}

}  // namespace windhover
