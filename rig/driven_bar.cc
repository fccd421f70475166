#include "rig/driven_bar.h"

#include <cmath>
#include <numbers>

#include "common/random/random_stream.h"
#include "rig/base_vibration.h"
#include "rig/isolator.h"
#include "rig/power_spectrum.h"

namespace windhover {
namespace {

using Complex = std::complex<double>;

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr Complex kI{0, 1};

// Of coordinate `i` of the bar.
const Mode& ModeOf(const BarModes& modes, std::size_t i) {
  const std::size_t direction = i % 3;
  return direction == 0 ? modes.forward : direction == 1 ? modes.up : modes.twist;
}

}  // namespace

DrivenBar::DrivenBar(const FlexConfig& flex, const VibrationConfig& vibration, double baseline_m,
                     std::uint64_t seed, const std::string& name)
    : modes_(ModesOf(flex, baseline_m)),
      isolator_(vibration.isolator),
      reference_hz_(vibration.rotors.reference_hz) {
  if (vibration.source != VibrationSource::kRotors || vibration.level == 0) return;
  const PresetFactors factors = FactorsOf(vibration.preset);
  const RotorToneConfig& rotors = vibration.rotors;
  const std::array<int, 3> orders = {1, 2, 4};
  const std::array<double, 3> amplitudes_mps2 = {rotors.a_1p_mps2, rotors.a_2p_mps2,
                                                 rotors.a_4p_mps2};
  // Turning shakes at the first two orders of four rotors, eight tones of equal power.
  const double rate_radps =
      vibration.angular_rate_rms_radps * factors.angular_rate * std::sqrt(2.0 / 8);
  RandomStream phases(seed, name + "/vibration/tones");
  for (std::vector<Tone>& tones : tones_) {
    for (std::size_t k = 0; k < orders.size(); ++k) {
      Tone& tone = tones.emplace_back();
      tone.order = orders[k];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        tone.acceleration_mps2[axis] = std::polar(
            vibration.level * factors.tones * vibration.axis_ratio[axis] * amplitudes_mps2[k],
            phases.Uniform(0, kTwoPi));
        tone.angular_rate_radps[axis] =
            std::polar(k < 2 ? vibration.level * rate_radps : 0, phases.Uniform(0, kTwoPi));
      }
    }
  }
}

std::array<double, 6> DrivenBar::Inputs(const Eigen::Vector3d& specific_force_B_mps2) const {
  const double forward = -modes_.participation * specific_force_B_mps2.x();
  const double up = -modes_.participation * (specific_force_B_mps2.z() - kStandardGravity_mps2);
  return {forward, up, 0, forward, up, 0};
}

DrivenBar::Tick::Tick(const DrivenBar& driven, const RigDrive& drive)
    : modes_(driven.modes_), start_s_(drive.start_s) {
  for (int rotor = 0; rotor < 4; ++rotor) {
    if (!(drive.rotor_rate_hz[rotor] >= 1)) continue;
    const int n_tones = static_cast<int>(driven.tones_[rotor].size());
    for (int tone = 0; tone < n_tones; ++tone) {
      lines_.push_back(MakeLine(driven, drive, rotor, tone));
    }
  }
  const std::array<double, 6> inputs = driven.Inputs(drive.specific_force_B_mps2);
  for (std::size_t i = 0; i < 6; ++i) held_[i] = UnderRamp(ModeOf(modes_, i), inputs[i], 0);
  if (!drive.bar || modes_.participation == 0) return;
  const BarState steady = At(start_s_).bar;
  for (std::size_t i = 0; i < 6; ++i) {
    ringing_[i] = (*drive.bar)[i] - steady[i];
    rings_ = rings_ || ringing_[i].x != 0 || ringing_[i].v != 0;
  }
}

DrivenBar::Tick::Line DrivenBar::Tick::MakeLine(const DrivenBar& driven, const RigDrive& drive,
                                                int rotor, int tone_number) const {
  const Tone& tone = driven.tones_[rotor][tone_number];
  const double rate_hz = drive.rotor_rate_hz[rotor], frequency_hz = tone.order * rate_hz;
  const double speed_ratio = rate_hz / driven.reference_hz_;
  const Complex gain =
      std::polar(speed_ratio * speed_ratio, kTwoPi * tone.order * drive.rotor_phase_rev[rotor]) *
      Transmissibility(driven.isolator_, frequency_hz);
  const Complex derivative = kTwoPi * frequency_hz * kI;
  const auto& [rate_forward, rate_left, rate_up] = tone.angular_rate_radps;

  Line line;
  line.frequency_hz = frequency_hz;
  line.turn_rad = {-gain * rate_left / derivative, -gain * rate_up / derivative,
                   gain * rate_forward / derivative};
  const Complex forward = gain * modes_.participation * tone.acceleration_mps2[0];
  const Complex up = gain * modes_.participation * tone.acceleration_mps2[2];
  const Complex turning = gain * derivative * modes_.angular_participation_m;
  const Complex twist = gain * derivative * modes_.twist_participation * rate_left *
                        Response(modes_.twist, frequency_hz);
  const Complex forward_response = Response(modes_.forward, frequency_hz);
  const Complex up_response = Response(modes_.up, frequency_hz);
  for (std::size_t end = 0; end < 2; ++end) {
    const double side = end == 0 ? -1 : 1;
    line.bar[3 * end] = -(forward + side * turning * rate_up) * forward_response;
    line.bar[3 * end + 1] = -(up - side * turning * rate_forward) * up_response;
    line.bar[3 * end + 2] = twist;
  }
  return line;
}

DrivenBar::Motion DrivenBar::Tick::At(double t_s) const {
  const double dt_s = t_s - start_s_;
  Motion motion{.bar = held_};
  for (std::size_t i = 0; rings_ && i < 6; ++i) {
    motion.bar[i] = held_[i] + Rung(ModeOf(modes_, i), ringing_[i], dt_s);
  }
  for (const Line& line : lines_) {
    const double rate_radps = kTwoPi * line.frequency_hz;
    const Complex now = std::polar(1.0, rate_radps * dt_s);
    for (int axis = 0; axis < 3; ++axis)
      motion.turn_rad[axis] += (line.turn_rad[axis] * now).real();
    for (std::size_t i = 0; i < 6; ++i) {
      const Complex value = line.bar[i] * now;
      motion.bar[i] = motion.bar[i] + ModeState{value.real(), -rate_radps * value.imag()};
    }
  }
  return motion;
}

DrivenBar::Motion DrivenBar::Tick::MeanAt(double t_s, double duration_s) const {
  const double dt_s = t_s - start_s_;
  Motion motion{.bar = held_};
  for (std::size_t i = 0; rings_ && i < 6; ++i) {
    motion.bar[i].x = held_[i].x + MeanRung(ModeOf(modes_, i), ringing_[i], dt_s, duration_s);
  }
  for (const Line& line : lines_) {
    const Complex mean = std::polar(Sinc(std::numbers::pi * (line.frequency_hz * duration_s)),
                                    kTwoPi * line.frequency_hz * dt_s);
    for (int axis = 0; axis < 3; ++axis) {
      motion.turn_rad[axis] += (line.turn_rad[axis] * mean).real();
    }
    for (std::size_t i = 0; i < 6; ++i) motion.bar[i].x += (line.bar[i] * mean).real();
  }
  return motion;
}

BarState DrivenBar::Stepped(const RigDrive& start, const RigDrive& end) const {
  const double dt_s = end.start_s - start.start_s;
  RigDrive even = start;
  for (std::size_t i = 0; i < 4; ++i) {
    if (dt_s > 0) {
      even.rotor_rate_hz[i] = (end.rotor_phase_rev[i] - start.rotor_phase_rev[i]) / dt_s;
    }
  }
  even.specific_force_B_mps2 = RigDrive{}.specific_force_B_mps2;  // Of which nothing bends.
  even.bar.reset();
  const Tick tones(*this, even);
  const BarState tones_start = tones.At(start.start_s).bar, tones_end = tones.At(end.start_s).bar;
  const BarState before = start.bar ? *start.bar : Tick(*this, start).At(start.start_s).bar;
  const std::array<double, 6> u0 = Inputs(start.specific_force_B_mps2);
  const std::array<double, 6> u1 = Inputs(end.specific_force_B_mps2);
  BarState after;
  for (std::size_t i = 0; i < 6; ++i) {
    after[i] = tones_end[i] + windhover::Stepped(ModeOf(modes_, i), before[i] - tones_start[i],
                                                 u0[i], u1[i], dt_s);
  }
  return after;
}

}  // namespace windhover
