#include "sweep/design.h"

#include <algorithm>
#include <numeric>

#include "common/random/random_stream.h"
#include "sweep/sobol_sequence.h"

namespace windhover {
namespace {

std::vector<DesignPoint> Grid(const std::vector<Factor>& factors) {
  std::vector<DesignPoint> points(1);
  for (const Factor& factor : factors) {
    std::vector<DesignPoint> longer;
    for (const DesignPoint& point : points) {
      for (const std::string& level : factor.Levels()) {
        longer.push_back(point);
        longer.back().push_back(level);
      }
    }
    points = std::move(longer);
  }
  return points;
}

std::vector<DesignPoint> OneAtATime(const std::vector<Factor>& factors,
                                    const DesignPoint& nominal) {
  std::vector<DesignPoint> points = {nominal};
  for (std::size_t f = 0; f < factors.size(); ++f) {
    for (const std::string& level : factors[f].Levels()) {
      if (level == nominal[f]) continue;
      points.push_back(nominal);
      points.back()[f] = level;
    }
  }
  return points;
}

/// Slice of each point, in an order drawn for this factor alone: another factor changes none.
std::vector<int> Shuffled(int n, RandomStream* random) {
  std::vector<int> slices(static_cast<std::size_t>(n));
  std::iota(slices.begin(), slices.end(), 0);
  for (std::size_t i = slices.size(); i > 1; --i) {
    std::swap(slices[i - 1],
              slices[static_cast<std::size_t>(random->Uniform() * static_cast<double>(i))]);
  }
  return slices;
}

std::vector<DesignPoint> LatinHypercube(const DesignConfig& design,
                                        const std::vector<Factor>& factors) {
  std::vector<DesignPoint> points(static_cast<std::size_t>(design.points));
  for (const Factor& factor : factors) {
    RandomStream random(design.seed, "sweep/" + factor.key());
    const std::vector<int> slices = Shuffled(design.points, &random);
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i].push_back(factor.At((slices[i] + random.Uniform()) / design.points));
    }
  }
  return points;
}

std::vector<DesignPoint> Sobol(const DesignConfig& design, const std::vector<Factor>& factors) {
  std::vector<DesignPoint> points(static_cast<std::size_t>(design.points));
  if (factors.empty()) return points;
  const SobolSequence sequence(static_cast<int>(factors.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::vector<double> u = sequence.Point(static_cast<std::uint32_t>(i));
    for (std::size_t f = 0; f < factors.size(); ++f) points[i].push_back(factors[f].At(u[f]));
  }
  return points;
}

}  // namespace

int CountDesignPoints(const DesignConfig& design, const std::vector<Factor>& factors) {
  const bool is_grid = design.type == DesignType::kGrid;
  if (!is_grid && design.type != DesignType::kOneAtATime) return design.points;
  double n = 1;
  for (const Factor& factor : factors) {
    const auto n_levels = static_cast<double>(factor.Levels().size());
    n = is_grid ? n * n_levels : n + n_levels;
  }
  return static_cast<int>(std::min(n, kMaxPoints + 1.0));
}

std::vector<DesignPoint> DesignPoints(const DesignConfig& design,
                                      const std::vector<Factor>& factors,
                                      const DesignPoint& nominal) {
  switch (design.type) {
    case DesignType::kGrid:
      return Grid(factors);
    case DesignType::kOneAtATime:
      return OneAtATime(factors, nominal);
    case DesignType::kLatinHypercube:
      return LatinHypercube(design, factors);
    case DesignType::kSobol:
      return Sobol(design, factors);
  }
  return {};
}

}  // namespace windhover
