#pragma once

#include <cstdint>
#include <string_view>

namespace windhover {

/// A random generator that belongs to one named purpose, such as "uav0/camera/left/noise".
///
/// Counter-based: the n-th draw is a function of (seed, name, n) alone, so any draw can be had
/// in any order and on any thread (`Seek`). Streams with different names are independent even
/// under the same seed: left and right cameras never share noise, which would cancel in the
/// disparity and flatter the estimator, and a new random effect leaves every other unchanged.
/// Source: SplitMix64's finaliser as a hash of the counter (Steele, Lea & Flood, OOPSLA 2014).
class RandomStream {
 public:
  using result_type = std::uint64_t;

  RandomStream(std::uint64_t seed, std::string_view name) : key_(Mix(seed) ^ HashName(name)) {}

  result_type operator()() { return Mix(key_ + kGolden * ++counter_); }
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return ~result_type{0}; }

  /// The next draw will be draw number `n`, counted from 0.
  void Seek(std::uint64_t n) { counter_ = n; }

  /// Uniform in [0, 1).
  double Uniform() { return static_cast<double>((*this)() >> 11) * 0x1p-53; }

  /// Uniform in [low, high).
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }

  /// Standard normal; one draw each (inverse of the cumulative distribution).
  double Normal();

 private:
  static constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ULL;

  static std::uint64_t Mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  static std::uint64_t HashName(std::string_view name) {
    std::uint64_t hash = 14695981039346656037ULL;  // FNV-1a, 64 bit
    for (const char c : name) {
      hash ^= static_cast<unsigned char>(c);
      hash *= 1099511628211ULL;
    }
    return Mix(hash);
  }

  std::uint64_t key_;
  std::uint64_t counter_ = 0;
};

}  // namespace windhover
