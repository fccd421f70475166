#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "budget/bar_angles.h"
#include "budget/source_lists.h"
#include "common/geometry/rotation.h"
#include "rig/half_bar.h"

namespace windhover {
namespace {

using D = Disturbance;

// The bar as it is, as warm and slipping as before.
void CopyBar(const FlexConfig& from, FlexConfig* to) {
  const FlexConfig before = *to;
  *to = from;
  to->thermal_gradient_K = before.thermal_gradient_K;
  to->thermal_mean_K = before.thermal_mean_K;
  to->drift = before.drift;
  to->landing = before.landing;
}

void AddVibration(const Scenario& scenario, ErrorSources* sources) {
  const VibrationConfig& vibration = scenario.vibration;
  if (vibration.source == VibrationSource::kNone || vibration.level == 0) return;
  sources->push_back(
      {.name = "vibration of the whole rig",
       .key = "vibration",
       .law = DistanceLaw::kNone,
       .switch_on = [](const Scenario& from, Scenario* to) { to->vibration = from.vibration; },
       // Both cameras turn alike, and a range is the same in every direction.
       .first_order = [](const Scenario&, const Sight&) { return Effect{}; }});
  if (!scenario.flex.enabled) return;
  const BarAngles rms = BarAnglesByVibration(scenario);
  sources->push_back({.name = "vibration bending the bar",
                      .key = "vibration, flex",
                      .law = DistanceLaw::kSquare,
                      .switch_on =
                          [](const Scenario& from, Scenario* to) {
                            to->vibration = from.vibration;
                            CopyBar(from.flex, &to->flex);
                          },
                      .first_order =
                          [rms](const Scenario&, const Sight& at) {
                            const RelativeAngles angles{.mean_deg = {},
                                                        .sigma_deg = {0, DegFromRad(rms.yaw_rad),
                                                                      DegFromRad(rms.roll_rad)}};
                            return OfAngles(angles, at);
                          }});
}

void AddBarRow(const char* name, const char* key, DistanceLaw law,
               void (*set)(const FlexConfig& from, FlexConfig* to),
               std::function<Effect(const Scenario&, const Sight&)> first_order,
               ErrorSources* sources) {
  sources->push_back({.name = name,
                      .key = key,
                      .law = law,
                      .switch_on =
                          [set](const Scenario& from, Scenario* to) {
                            CopyBar(from.flex, &to->flex);
                            set(from.flex, &to->flex);
                          },
                      .first_order = std::move(first_order)});
}

void AddWarmth(const Scenario& scenario, ErrorSources* sources) {
  const FlexConfig& flex = scenario.flex;
  const BarSection section = SectionOf(flex);
  const double baseline_m = scenario.rig.calibrated.baseline_m;
  if (flex.thermal_gradient_K != 0) {
    const double yaw_rad =
        section.expansion_per_K * flex.thermal_gradient_K * baseline_m / section.depth_m;
    AddBarRow(
        "bar warmer in front", "flex.thermal_gradient_K", DistanceLaw::kSquare,
        [](const FlexConfig& from, FlexConfig* to) {
          to->thermal_gradient_K = from.thermal_gradient_K;
        },
        [=](const Scenario&, const Sight& at) { return OfAmount(D::kRelativeYaw, at, yaw_rad); },
        sources);
  }
  if (flex.thermal_mean_K != 0) {
    const double longer_m = section.expansion_per_K * flex.thermal_mean_K * baseline_m;
    AddBarRow(
        "bar warmer than calibrated", "flex.thermal_mean_K", DistanceLaw::kLinear,
        [](const FlexConfig& from, FlexConfig* to) { to->thermal_mean_K = from.thermal_mean_K; },
        [=](const Scenario&, const Sight& at) { return OfAmount(D::kBaseline, at, longer_m); },
        sources);
  }
}

void AddSlips(const Scenario& scenario, ErrorSources* sources) {
  const DriftConfig& drift = scenario.flex.drift;
  const RelativeAngles drifts{
      .mean_deg = {},
      .sigma_deg = {drift.pitch_sigma_deg, drift.yaw_sigma_deg, drift.roll_sigma_deg}};
  if (drifts.sigma_deg != std::array<double, 3>{}) {
    AddBarRow(
        "drift of the bar", "flex.drift", DistanceLaw::kSquare,
        [](const FlexConfig& from, FlexConfig* to) { to->drift = from.drift; },
        [=](const Scenario&, const Sight& at) { return OfAngles(drifts, at); }, sources);
  }
  const LandingConfig& landing = scenario.flex.landing;
  const std::array angles_deg = {landing.pitch_deg, landing.yaw_deg, landing.roll_deg};
  // The share of the flight that comes after it.
  const double after = std::clamp(1 - landing.time_s / scenario.duration_s, 0.0, 1.0);
  if (after == 0 || angles_deg == std::array<double, 3>{}) return;
  AddBarRow(
      "hard landing", "flex.landing", DistanceLaw::kSquare,
      [](const FlexConfig& from, FlexConfig* to) { to->landing = from.landing; },
      [=](const Scenario&, const Sight& at) {
        // All three angles come at once: one disturbance that is there or not.
        const Effect then = OfAngles({angles_deg, {}}, at);
        return Effect{after * then.bias_m, std::abs(then.bias_m) * std::sqrt(after * (1 - after)),
                      then.left_out};
      },
      sources);
}

}  // namespace

void AddBarSources(const Scenario& scenario, ErrorSources* sources) {
  AddVibration(scenario, sources);
  if (!scenario.flex.enabled) return;
  AddWarmth(scenario, sources);
  AddSlips(scenario, sources);
}

}  // namespace windhover
