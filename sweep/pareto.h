#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace windhover {

/// Indices of those that no other is better than in one coordinate and at least as good in the
/// other, by the first coordinate; less is better in both.
std::vector<std::size_t> ParetoFront(const std::vector<std::array<double, 2>>& points);

}  // namespace windhover
