// What the detector's boxes and the UWB labels add.

#include <cmath>
#include <utility>

#include "budget/label_error.h"
#include "budget/source_lists.h"

namespace windhover {
namespace {

double BoxSigma_px(const Scenario& scenario, const Sight& at) {
  const double width_px =
      scenario.rig.calibrated.FocalPx() * scenario.estimator.target_width_m / at.depth_m;
  const GeometricConfig& boxes = scenario.geometric;
  return std::hypot(boxes.sigma_px, boxes.sigma_relative * width_px);
}

// Of the target, from the rig.
Eigen::Vector3d Direction(const Sight& at) {
  return Eigen::Vector3d((at.x + at.x_right()) / 2, at.y, 1).normalized();
}

// Labels that are right but for what `set` copies.
void AddLabelRow(const char* name, const char* key,
                 void (*set)(const UwbConfig& from, UwbConfig* to),
                 Effect (*first_order)(const Scenario&, const Sight&), ErrorSources* sources) {
  sources->push_back({.name = name,
                      .key = key,
                      .law = DistanceLaw::kConstant,
                      .switch_on =
                          [set](const Scenario& from, Scenario* to) {
                            to->score.reference = ScoreReference::kUwb;
                            set(from.uwb, &to->uwb);
                          },
                      .first_order = first_order});
}

void AddLatency(ErrorSources* sources) {
  AddLabelRow(
      "latency of the label", "uwb.latency_s, uwb.latency_sigma_s",
      [](const UwbConfig& from, UwbConfig* to) {
        to->latency_s = from.latency_s;
        to->latency_sigma_s = from.latency_sigma_s;
      },
      [](const Scenario& of, const Sight& at) {
        const double rate_mps = at.v_mps.dot(Direction(at));
        return Effect{rate_mps * of.uwb.latency_s, std::abs(rate_mps) * of.uwb.latency_sigma_s};
      },
      sources);
}

}  // namespace

void AddBoxSources(const Scenario& scenario, ErrorSources* sources) {
  const GeometricConfig& boxes = scenario.geometric;
  if (scenario.observe != Observe::kGeometric) return;
  if (boxes.sigma_px > 0 || boxes.sigma_relative > 0) {
    sources->push_back({.name = "noise of the boxes",
                        .key = "geometric",
                        .law = DistanceLaw::kSquare,
                        .switch_on =
                            [](const Scenario& from, Scenario* to) {
                              to->geometric = from.geometric;
                              to->geometric.gross_rate = 0;
                              to->geometric.miss_rate = 0;
                            },
                        .first_order =
                            [](const Scenario& of, const Sight& at) {
                              const double sigma_px = BoxSigma_px(of, at);
                              return OfDisparity(
                                  at, 0,
                                  DisparitySigma_px(sigma_px, sigma_px, of.geometric.correlation));
                            }});
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
                        .first_order =
                            [](const Scenario& of, const Sight& at) {
                              const double width_px = of.rig.calibrated.FocalPx() *
                                                      of.estimator.target_width_m / at.depth_m;
                              return OfDisparity(at, 0,
                                                 std::sqrt(2 * of.geometric.gross_rate) *
                                                     of.geometric.gross_sigma * width_px);
                            }});
  }
}

void AddLabelSources(const Scenario& scenario, ErrorSources* sources) {
  if (scenario.score.reference != ScoreReference::kUwb) return;
  const UwbConfig& uwb = scenario.uwb;
  AddLabelRow(
      "lever of the label's antenna", "rig.mount, uwb.antenna_m",
      [](const UwbConfig& from, UwbConfig* to) { to->antenna_m = from.antenna_m; },
      [](const Scenario& of, const Sight& at) {
        return Effect{AntennaInRig_m(of).dot(Direction(at)), 0};
      },
      sources);
  if (uwb.sigma_m > 0 || uwb.antenna_delay_sigma_m > 0) {
    AddLabelRow(
        "noise of the label", "uwb.sigma_m, uwb.antenna_delay_sigma_m",
        [](const UwbConfig& from, UwbConfig* to) {
          to->sigma_m = from.sigma_m;
          to->antenna_delay_sigma_m = from.antenna_delay_sigma_m;
        },
        [](const Scenario& of, const Sight&) {
          return Effect{0, std::hypot(of.uwb.sigma_m, of.uwb.antenna_delay_sigma_m)};
        },
        sources);
  }
  if (uwb.bias_m != 0) {
    AddLabelRow(
        "bias of the label", "uwb.bias_m",
        [](const UwbConfig& from, UwbConfig* to) { to->bias_m = from.bias_m; },
        [](const Scenario& of, const Sight&) {
          return Effect{-of.uwb.bias_m, 0};
        },
        sources);
  }
  if (uwb.latency_s != 0 || uwb.latency_sigma_s != 0) AddLatency(sources);
}

}  // namespace windhover
