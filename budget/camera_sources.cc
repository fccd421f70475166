// What the lenses add by focus and warmth, and the shutters by their times.

#include <array>
#include <cmath>
#include <utility>

#include "budget/rig_turns.h"
#include "budget/source_lists.h"

namespace windhover {
namespace {

using D = Disturbance;
using OneCamera = OpticsConfig::OneCamera;

double DisparityBy_px(D disturbance, const Sight& at, double amount) {
  return RowOf(disturbance).disparity_px(at) * amount;
}

// Of focal lengths that differ from the calibrated one by these shares.
Effect OfMagnification(const Sight& at, double left, double right) {
  return OfDisparity(at,
                     DisparityBy_px(D::kLeftFocal, at, at.focal_px * left) +
                         DisparityBy_px(D::kRightFocal, at, at.focal_px * right),
                     0);
}

DistanceLaw LawOf(double left, double right) {
  return left == right ? DistanceLaw::kLinear : DistanceLaw::kSquare;
}

void AddFocus(const Scenario& scenario, ErrorSources* sources) {
  const OpticsConfig& optics = scenario.optics;
  const double focal_m = 1e-3 * scenario.rig.calibrated.focal_mm;
  const double left = FocusMagnification(focal_m, optics.FocusOf(optics.left)) - 1;
  const double right = FocusMagnification(focal_m, optics.FocusOf(optics.right)) - 1;
  if (left == 0 && right == 0) return;
  sources->push_back(
      {.name = "focus nearer than calibrated",
       .key = "optics.focus_m",
       .law = LawOf(left, right),
       .switch_on =
           [](const Scenario& from, Scenario* to) {
             to->optics.focus_m = from.optics.focus_m;
             to->optics.left.focus_m = from.optics.left.focus_m;
             to->optics.right.focus_m = from.optics.right.focus_m;
           },
       .first_order = [=](const Scenario&,
                          const Sight& at) { return OfMagnification(at, left, right); }});
}

void AddWarmLenses(const Scenario& scenario, ErrorSources* sources) {
  const OpticsConfig& optics = scenario.optics;
  const double warmer_K = optics.temperature_change_K;
  const double left = warmer_K * optics.ThermalFocusOf(optics.left);
  const double right = warmer_K * optics.ThermalFocusOf(optics.right);
  if (left == 0 && right == 0) return;
  sources->push_back(
      {.name = "lenses warmer than calibrated",
       .key = "optics.thermal_focus_per_K",
       .law = LawOf(left, right),
       .switch_on =
           [](const Scenario& from, Scenario* to) {
             to->optics.temperature_change_K = from.optics.temperature_change_K;
             to->optics.thermal_focus_per_K = from.optics.thermal_focus_per_K;
             to->optics.left.thermal_focus_per_K = from.optics.left.thermal_focus_per_K;
             to->optics.right.thermal_focus_per_K = from.optics.right.thermal_focus_per_K;
           },
       .first_order = [=](const Scenario&,
                          const Sight& at) { return OfMagnification(at, left, right); }});
}

void AddWarmSensors(const Scenario& scenario, ErrorSources* sources) {
  const OpticsConfig& optics = scenario.optics;
  const double offset_px =
      optics.temperature_change_K * (optics.left.cx_px_per_K - optics.right.cx_px_per_K);
  if (offset_px == 0) return;
  sources->push_back(
      {.name = "warmth moving the principal points",
       .key = "optics.left.cx_px_per_K, optics.right.cx_px_per_K",
       .law = DistanceLaw::kSquare,
       .switch_on =
           [](const Scenario& from, Scenario* to) {
             to->optics.temperature_change_K = from.optics.temperature_change_K;
             to->optics.left.cx_px_per_K = from.optics.left.cx_px_per_K;
             to->optics.right.cx_px_per_K = from.optics.right.cx_px_per_K;
           },
       .first_order = [=](const Scenario&,
                          const Sight& at) { return OfAmount(D::kOffset, at, offset_px); }});
}

// The target moves between the exposures, and so does the rig that shakes.
void AddSkew(const Scenario& scenario, ErrorSources* sources) {
  const ExposureConfig& exposure = scenario.exposure;
  if (exposure.skew_ms == 0 && exposure.jitter_ms == 0) return;
  const double skew_s = 1e-3 * exposure.skew_ms, jitter_s = 1e-3 * exposure.jitter_ms;
  const std::array<double, 3> turns_rad = RigTurnsWithin(scenario, skew_s, std::sqrt(2) * jitter_s);
  sources->push_back(
      {.name = "skew of the exposures",
       .key = "exposure.skew_ms, exposure.jitter_ms, vibration",
       .law = DistanceLaw::kLinear,
       .switch_on =
           [](const Scenario& from, Scenario* to) {
             to->exposure.skew_ms = from.exposure.skew_ms;
             to->exposure.jitter_ms = from.exposure.jitter_ms;
             to->vibration = from.vibration;
           },
       .first_order =
           [=](const Scenario&, const Sight& at) {
             Sight as_left = at;  // Seen by a right camera where the left one is.
             as_left.x += at.baseline_m / at.depth_m;
             const double right_px = DisparityBy_px(D::kSkew, at, jitter_s);
             const double left_px = -DisparityBy_px(D::kSkew, as_left, jitter_s);
             double variance_px2 = right_px * right_px + left_px * left_px;
             constexpr std::array kTurns = {D::kRightPitch, D::kRightYaw, D::kRightRoll};
             for (std::size_t axis = 0; axis < 3; ++axis) {
               variance_px2 += std::pow(DisparityBy_px(kTurns[axis], at, turns_rad[axis]), 2);
             }
             return OfDisparity(at, DisparityBy_px(D::kSkew, at, skew_s), std::sqrt(variance_px2));
           }});
}

// Both cameras see the target when its row is exposed, not when the frame is due.
void AddRollingShutter(const Scenario& scenario, ErrorSources* sources) {
  const ExposureConfig& exposure = scenario.exposure;
  if (exposure.shutter != Shutter::kRolling || exposure.row_time_us == 0) return;
  sources->push_back({.name = "rolling shutter",
                      .key = "exposure.row_time_us",
                      .law = DistanceLaw::kConstant,
                      .switch_on =
                          [](const Scenario& from, Scenario* to) {
                            to->exposure.shutter = from.exposure.shutter;
                            to->exposure.row_time_us = from.exposure.row_time_us;
                          },
                      .first_order =
                          [](const Scenario& of, const Sight& at) {
                            const double later_s =
                                1e-6 * of.exposure.row_time_us * at.focal_px * at.y;
                            return Effect{later_s * RangeRate_mps(at), 0};
                          }});
}

}  // namespace

void AddLensSources(const Scenario& scenario, ErrorSources* sources) {
  AddFocus(scenario, sources);
  AddWarmLenses(scenario, sources);
  AddWarmSensors(scenario, sources);
}

void AddShutterSources(const Scenario& scenario, ErrorSources* sources) {
  AddSkew(scenario, sources);
  AddRollingShutter(scenario, sources);
}

}  // namespace windhover
