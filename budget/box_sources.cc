// What the detector's boxes add.

#include <cmath>
#include <utility>

#include "budget/source_lists.h"

namespace windhover {
namespace {

double Width_px(const Scenario& scenario, const Sight& at) {
  return scenario.rig.calibrated.FocalPx() * scenario.estimator.target_width_m / at.depth_m;
}

Effect Noise(const Scenario& of, const Sight& at) {
  const GeometricConfig& boxes = of.geometric;
  const double width_px = Width_px(of, at);
  const double sigma_px = std::hypot(boxes.sigma_px, boxes.sigma_relative * width_px);
  return OfDisparity(at, 0, DisparitySigma_px(sigma_px, sigma_px, CorrelationOfX(boxes, width_px)));
}

// Rare and large: small enough for first order is one of them, not their mean.
Effect GrossErrors(const Scenario& of, const Sight& at) {
  const double one_px = of.geometric.gross_sigma * Width_px(of, at);
  Effect effect = OfDisparity(at, 0, std::sqrt(2 * of.geometric.gross_rate) * one_px);
  effect.left_out = OfDisparity(at, 0, one_px).left_out;
  return effect;
}

}  // namespace

void AddBoxSources(const Scenario& scenario, ErrorSources* sources) {
  const GeometricConfig& boxes = scenario.geometric;
  if (scenario.observe != Observe::kGeometric) return;
  if (boxes.sigma_px > 0 || boxes.sigma_relative > 0) {
    sources->push_back({.name = "noise of the boxes",
                        .key = "geometric.sigma_px, geometric.sigma_relative",
                        .law = DistanceLaw::kSquare,
                        .switch_on =
                            [](const Scenario& from, Scenario* to) {
                              to->geometric.sigma_px = from.geometric.sigma_px;
                              to->geometric.sigma_relative = from.geometric.sigma_relative;
                              to->geometric.correlation = from.geometric.correlation;
                              to->geometric.correlation_width_px =
                                  from.geometric.correlation_width_px;
                            },
                        .first_order = Noise});
  }
  if (boxes.gross_rate > 0) {
    sources->push_back({.name = "misplaced boxes",
                        .key = "geometric.gross_rate",
                        .law = DistanceLaw::kLinear,
                        .switch_on =
                            [](const Scenario& from, Scenario* to) {
                              to->geometric.gross_rate = from.geometric.gross_rate;
                              to->geometric.gross_sigma = from.geometric.gross_sigma;
                            },
                        .first_order = GrossErrors});
  }
}

}  // namespace windhover
