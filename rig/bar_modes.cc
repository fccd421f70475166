#include "rig/bar_modes.h"

#include <numbers>

#include "rig/half_bar.h"

namespace windhover {

TipMotion MotionOf(const TipDeflection& tip, double half_span_m, int side) {
  // Tips that bend forward turn towards each other: the right one about -y. Tips that bend up
  // raise the bar's outer ends: the right one turns about -z. (x right, y down, z forward.)
  return {.shift_m = {0, -tip.up_m, tip.forward_m},
          .turn_rad = {tip.twist_rad, -side * TipSlope_rad(tip.forward_m, half_span_m),
                       -side * TipSlope_rad(tip.up_m, half_span_m)}};
}

BarModes ModesOf(const FlexConfig& flex, double baseline_m) {
  const HalfBar bar = MakeHalfBar(flex, baseline_m);
  const auto bending = [&](double EI_Nm2) {
    const double frequency_radps = flex.frequency_hz > 0 ? 2 * std::numbers::pi * flex.frequency_hz
                                                         : BendingFrequency_radps(bar, EI_Nm2);
    return Mode{frequency_radps, flex.damping};
  };
  const double is_flexible = flex.enabled ? 1 : 0;
  return {.forward = bending(bar.section.EI_forward_Nm2),
          .up = bending(bar.section.EI_up_Nm2),
          .twist = {TorsionFrequency_radps(bar), flex.damping},
          .participation =
              is_flexible * (flex.participation > 0 ? flex.participation : Participation(bar)),
          .angular_participation_m = is_flexible * AngularParticipation_m(bar),
          .twist_participation = is_flexible};
}

std::array<double, 12> ValuesOf(const BarState& state) {
  std::array<double, 12> values{};
  for (std::size_t i = 0; i < state.size(); ++i) {
    values[2 * i] = state[i].x;
    values[2 * i + 1] = state[i].v;
  }
  return values;
}

BarState BarStateFrom(const std::array<double, 12>& values) {
  BarState state;
  for (std::size_t i = 0; i < state.size(); ++i) state[i] = {values[2 * i], values[2 * i + 1]};
  return state;
}

}  // namespace windhover
