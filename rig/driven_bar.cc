#include "rig/driven_bar.h"

#include <cmath>
#include <numbers>
#include <tuple>

#include "common/random/random_stream.h"
#include "rig/base_vibration.h"
#include "rig/isolator.h"
#include "rig/power_spectrum.h"
#include "rig/sinusoids.h"

namespace windhover {
namespace {

using Complex = std::complex<double>;

constexpr double kTwoPi = 2 * std::numbers::pi;

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
      AddTone(driven, drive, rotor, tone);
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

void DrivenBar::Tick::AddTone(const DrivenBar& driven, const RigDrive& drive, int rotor,
                              int tone_number) {
  const Tone& tone = driven.tones_[rotor][tone_number];
  const double rate_hz = drive.rotor_rate_hz[rotor], frequency_hz = tone.order * rate_hz;
  const double speed_ratio = rate_hz / driven.reference_hz_;
  const Complex gain =
      std::polar(speed_ratio * speed_ratio, kTwoPi * tone.order * drive.rotor_phase_rev[rotor]) *
      Transmissibility(driven.isolator_, frequency_hz);
  const auto& [rate_forward, rate_left, rate_up] = tone.angular_rate_radps;
  const Complex integral = gain * Integration(frequency_hz);
  const Complex derivative = gain * Differentiation(frequency_hz);
  const Complex forward = gain * modes_.participation * tone.acceleration_mps2[0];
  const Complex up = gain * modes_.participation * tone.acceleration_mps2[2];
  const Complex turning = derivative * modes_.angular_participation_m;
  const Complex forward_response = Response(modes_.forward, frequency_hz);
  const Complex up_response = Response(modes_.up, frequency_hz);
  const Complex twist =
      derivative * modes_.twist_participation * rate_left * Response(modes_.twist, frequency_hz);
  const std::array<Complex, 9> amplitudes = {-integral * rate_left,
                                             -integral * rate_up,
                                             integral * rate_forward,
                                             -(forward - turning * rate_up) * forward_response,
                                             -(up + turning * rate_forward) * up_response,
                                             twist,
                                             -(forward + turning * rate_up) * forward_response,
                                             -(up - turning * rate_forward) * up_response,
                                             twist};
  Block& block = blocks_[n_tones_ / kLanes];
  const std::size_t lane = n_tones_ % kLanes;
  block.frequencies_hz[lane] = frequency_hz;
  for (std::size_t i = 0; i < amplitudes.size(); ++i) {
    block.real[i][lane] = amplitudes[i].real();
    block.imaginary[i][lane] = amplitudes[i].imag();
  }
  ++n_tones_;
}

// All tones at `dt_s` after the start or, where `mean_over_s` is not 0, their means about it.
void DrivenBar::Tick::AddSteadyTones(double dt_s, double mean_over_s, Motion* motion) const {
  const std::size_t n_blocks = (n_tones_ + kLanes - 1) / kLanes;
  std::array<Lanes, std::tuple_size_v<decltype(blocks_)>> rates_radps, cos, sin;
  for (std::size_t i = 0; i < n_blocks; ++i) {
    Lanes frequencies_hz;
    Load(blocks_[i].frequencies_hz.data(), &frequencies_hz);
    rates_radps[i] = kTwoPi * frequencies_hz;
    CosSin(frequencies_hz * dt_s, &cos[i], &sin[i]);
    for (std::size_t lane = 0; mean_over_s > 0 && lane < kLanes; ++lane) {
      const double left = Sinc(rates_radps[i][lane] * mean_over_s / 2);
      cos[i][lane] *= left;
      sin[i][lane] *= left;
    }
  }
  for (std::size_t k = 0; k < 9; ++k) {
    Lanes values{}, derivatives{};
    for (std::size_t i = 0; i < n_blocks; ++i) {
      Lanes real, imaginary;
      Load(blocks_[i].real[k].data(), &real);
      Load(blocks_[i].imaginary[k].data(), &imaginary);
      values += real * cos[i] - imaginary * sin[i];
      derivatives -= rates_radps[i] * (real * sin[i] + imaginary * cos[i]);
    }
    if (k < 3) {
      motion->turn_rad[static_cast<int>(k)] += Sum(values);
    } else {
      motion->bar[k - 3] = motion->bar[k - 3] + ModeState{Sum(values), Sum(derivatives)};
    }
  }
}

DrivenBar::Motion DrivenBar::Tick::At(double t_s) const {
  const double dt_s = t_s - start_s_;
  Motion motion{.bar = held_};
  for (std::size_t i = 0; rings_ && i < 6; ++i) {
    motion.bar[i] = held_[i] + Rung(ModeOf(modes_, i), ringing_[i], dt_s);
  }
  if (n_tones_ > 0) AddSteadyTones(dt_s, 0, &motion);
  return motion;
}

DrivenBar::Motion DrivenBar::Tick::MeanAt(double t_s, double duration_s) const {
  const double dt_s = t_s - start_s_;
  Motion motion{.bar = held_};
  for (std::size_t i = 0; rings_ && i < 6; ++i) {
    motion.bar[i].x = held_[i].x + MeanRung(ModeOf(modes_, i), ringing_[i], dt_s, duration_s);
  }
  if (n_tones_ > 0) AddSteadyTones(dt_s, duration_s, &motion);
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
