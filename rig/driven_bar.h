#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "rig/bar_modes.h"
#include "rig/lanes.h"
#include "rig/vibration.h"

namespace windhover {

/// What drives the rig from a moment on, as UAV_TRUTH says it: rotors turn on at their rates, the
/// body goes on with its acceleration.
struct RigDrive {
  double start_s = 0;
  std::array<double, 4> rotor_phase_rev{};  ///< At start_s.
  std::array<double, 4> rotor_rate_hz{};    ///< Below 1: makes no tone.
  /// Acceleration less gravity of the rig's root along forward, left, up; in level flight
  /// (0, 0, 9.80665), as when the rig was calibrated.
  Eigen::Vector3d specific_force_B_mps2{0, 0, 9.80665};
  /// Of the bar at start_s, without the part of broadband vibration; nothing: it has long been
  /// driven like this.
  std::optional<BarState> bar;
};

/// How rotors and manoeuvres turn and bend the rig. Within a tick a closed form of time: the
/// steady response to the rotors' tones and to the acceleration, and what rings since the start.
class DrivenBar {
 public:
  /// `name` ("uav0") makes the phases of the tones this aircraft's own.
  DrivenBar(const FlexConfig& flex, const VibrationConfig& vibration, double baseline_m,
            std::uint64_t seed, const std::string& name);

  struct Motion {
    Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();  ///< Of the whole rig, in R.
    BarState bar;
  };

  /// What is the same for all times of one drive.
  class Tick {
   public:
    Tick(const DrivenBar& driven, const RigDrive& drive);

    Motion At(double t_s) const;

    /// The mean over `duration_s` about `t_s`; velocities mean nothing. @pre duration_s > 0
    Motion MeanAt(double t_s, double duration_s) const;

   private:
    // Eight tones of rotors: frequencies, and as complex amplitudes at start_s the turn of the rig
    // (three), then the bar.
    struct Block {
      std::array<double, kLanes> frequencies_hz{};
      std::array<std::array<double, kLanes>, 9> real{}, imaginary{};
    };
    static constexpr std::size_t kMaxTones = 12;

    void AddTone(const DrivenBar& driven, const RigDrive& drive, int rotor, int tone);
    void AddSteadyTones(double dt_s, double mean_over_s, Motion* motion) const;

    BarModes modes_;
    double start_s_;
    std::array<Block, (kMaxTones + kLanes - 1) / kLanes> blocks_;
    std::size_t n_tones_ = 0;
    BarState held_;     ///< Under the acceleration, for good.
    BarState ringing_;  ///< What is left at start_s.
    bool rings_ = false;
  };

  /// The bar at `end.start_s`, whose own bar is not looked at: exact for rotors that turn evenly
  /// from phase to phase and an acceleration that changes evenly.
  BarState Stepped(const RigDrive& start, const RigDrive& end) const;

 private:
  // Complex amplitudes at RotorToneConfig::reference_hz along and about forward, left, up.
  struct Tone {
    int order = 1;
    std::array<std::complex<double>, 3> acceleration_mps2, angular_rate_radps;
  };

  // What drives each coordinate of the bar under a specific force.
  std::array<double, 6> Inputs(const Eigen::Vector3d& specific_force_B_mps2) const;

  BarModes modes_;
  IsolatorConfig isolator_;
  double reference_hz_;
  std::array<std::vector<Tone>, 4> tones_;  ///< Of each rotor; none or three.
};

}  // namespace windhover
