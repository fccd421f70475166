#pragma once

#include <cstdint>

#include "scenarios/sensor_config.h"

namespace windhover {

/// Where the randomness of one row of one image comes from.
struct SensorRowKeys {
  std::uint64_t frame;    ///< Differs between rows, images and cameras.
  std::uint64_t pattern;  ///< Differs between rows and cameras, not between images.
};

/// The linear camera model of EMVA Standard 1288, release 4.0:
///
///     electrons   e ~ min(Poisson(η Φ (1 + PRNU) + I_d t), full well),  I_d = I_25 2^((T - 25
///     °C)/T_2) grey value  y = round(K (e + DSNU + N(0, σ_read²)) + offset), within 0 … 2^bits - 1
///
/// PRNU and DSNU are normal patterns that belong to a camera. A Poisson mean above 32 is drawn as
/// a normal one. Every operation is one that IEEE 754 rounds exactly: the same bits everywhere.
class EmvaSensor {
 public:
  explicit EmvaSensor(const SensorConfig& config);

  /// Turns `count` values of light in place (65535: white, photons_at_white on a pixel) into grey
  /// values, scaled so that 65535 is the largest one. `gain` multiplies K.
  void Expose(const SensorRowKeys& keys, double exposure_s, double gain, int count,
              std::uint16_t* values) const;

  /// Grey values an electron, K.
  double GainDnPerE() const { return gain_dn_per_e_; }
  double LargestDn() const { return largest_dn_; }
  /// Electrons that the dark current leaves in an exposure.
  double DarkElectrons(double exposure_s) const { return dark_current_e_per_s_ * exposure_s; }

 private:
  bool noise_;
  float electrons_per_light_;
  double dark_current_e_per_s_;
  float full_well_e_, read_noise_e_, prnu_, dsnu_e_;
  double gain_dn_per_e_, offset_dn_, largest_dn_;
};

}  // namespace windhover
