#pragma once

#include <cstdlib>
#include <string_view>

namespace windhover {

/// Instructions that loops are written for; each includes those before it. kAvx512 means its
/// subsets F, BW, DQ and VL. All give the same bits: the choice is one of speed.
enum class InstructionSet { kSse2, kAvx2, kAvx512 };

/// The widest that this processor has, but no wider than the environment variable WINDHOVER_ISA
/// (sse2, avx2, avx512) where that is set, so that one machine can time them all. Asked once a
/// process.
inline InstructionSet WidestInstructionSet() {
  static const InstructionSet widest = [] {
    const char* name = std::getenv("WINDHOVER_ISA");
    const std::string_view limit = name == nullptr ? "avx512" : name;
    const bool has_avx512 =
        __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
    if (has_avx512 && limit != "avx2" && limit != "sse2") return InstructionSet::kAvx512;
    if (__builtin_cpu_supports("avx2") && limit != "sse2") return InstructionSet::kAvx2;
    return InstructionSet::kSse2;
  }();
  return widest;
}

}  // namespace windhover
