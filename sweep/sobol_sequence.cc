#include "sweep/sobol_sequence.h"

#include <array>
#include <stdexcept>

namespace windhover {
namespace {

constexpr int kBits = 32;

/// A primitive polynomial of degree s with inner coefficients a, and the first s odd numbers m.
struct Row {
  int s;
  std::uint32_t a;
  std::array<std::uint32_t, 6> m;
};

// Dimensions 2 to 16; the first is van der Corput's sequence.
constexpr std::array<Row, SobolSequence::kMaxDimensions - 1> kRows = {
    {{1, 0, {1}},
     {2, 1, {1, 3}},
     {3, 1, {1, 3, 1}},
     {3, 2, {1, 1, 1}},
     {4, 1, {1, 1, 3, 3}},
     {4, 4, {1, 3, 5, 13}},
     {5, 2, {1, 1, 5, 5, 17}},
     {5, 4, {1, 1, 5, 5, 5}},
     {5, 7, {1, 1, 7, 11, 19}},
     {5, 11, {1, 1, 5, 1, 1}},
     {5, 13, {1, 1, 1, 3, 11}},
     {5, 14, {1, 3, 5, 5, 31}},
     {6, 1, {1, 3, 3, 9, 7, 49}},
     {6, 13, {1, 1, 1, 15, 21, 21}},
     {6, 16, {1, 3, 1, 13, 27, 49}}}};

std::vector<std::uint32_t> FirstDirections() {
  std::vector<std::uint32_t> v;
  for (int i = 0; i < kBits; ++i) v.push_back(std::uint32_t{1} << (kBits - 1 - i));
  return v;
}

std::vector<std::uint32_t> Directions(const Row& row) {
  std::vector<std::uint32_t> v(kBits);
  for (int i = 0; i < row.s; ++i) {
    v[static_cast<std::size_t>(i)] = row.m[static_cast<std::size_t>(i)] << (kBits - 1 - i);
  }
  for (int i = row.s; i < kBits; ++i) {
    const auto at = [&](int k) { return v[static_cast<std::size_t>(i - k)]; };
    std::uint32_t value = at(row.s) ^ (at(row.s) >> row.s);
    for (int k = 1; k < row.s; ++k) {
      if (((row.a >> (row.s - 1 - k)) & 1U) != 0) value ^= at(k);
    }
    v[static_cast<std::size_t>(i)] = value;
  }
  return v;
}

}  // namespace

SobolSequence::SobolSequence(int dimensions) {
  if (dimensions < 1 || dimensions > kMaxDimensions) {
    throw std::invalid_argument("a Sobol sequence must have 1 to 16 dimensions");
  }
  directions_.push_back(FirstDirections());
  for (int d = 1; d < dimensions; ++d) {
    directions_.push_back(Directions(kRows[static_cast<std::size_t>(d - 1)]));
  }
}

std::vector<double> SobolSequence::Point(std::uint32_t n) const {
  const std::uint32_t gray = n ^ (n >> 1);
  std::vector<double> point;
  for (const auto& v : directions_) {
    std::uint32_t x = 0;
    for (int bit = 0; bit < kBits; ++bit) {
      if (((gray >> bit) & 1U) != 0) x ^= v[static_cast<std::size_t>(bit)];
    }
    point.push_back((x + 0.5) * 0x1p-32);
  }
  return point;
}

}  // namespace windhover
