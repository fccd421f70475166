#pragma once

#include <string>
#include <vector>

#include "sweep/factor.h"

namespace windhover {

/// One value, as YAML, for each factor.
using DesignPoint = std::vector<std::string>;

/// How many points a design has, to be known before they are made; beyond kMaxPoints any number
/// that is.
int CountDesignPoints(const DesignConfig& design, const std::vector<Factor>& factors);

/// The points of a design, in an order that is always the same.
///
/// grid: every combination, the last factor's values changing first. latin_hypercube: n equally
/// likely slices of each factor, each used once (M. D. McKay et al., Technometrics 21(2), 1979).
/// sobol: SobolSequence, from its first point on. one_at_a_time: `nominal` first, then each
/// factor's other levels while the rest stay there.
std::vector<DesignPoint> DesignPoints(const DesignConfig& design,
                                      const std::vector<Factor>& factors,
                                      const DesignPoint& nominal);

}  // namespace windhover
