#pragma once

#include "common/config/fields.h"

namespace windhover {

/// fast: shot and read noise alone. emva1288: all of the standard's linear camera model.
enum class SensorModel { kFast, kEmva1288 };
template <>
inline constexpr EnumNames<SensorModel> kEnumNames<SensorModel>{
    {SensorModel::kFast, "fast"}, {SensorModel::kEmva1288, "emva1288"}};

/// From linear light to the bytes of an image.
enum class TransferCurve { kSrgb, kGamma22, kLinear };
template <>
inline constexpr EnumNames<TransferCurve> kEnumNames<TransferCurve>{
    {TransferCurve::kSrgb, "srgb"},
    {TransferCurve::kGamma22, "gamma22"},
    {TransferCurve::kLinear, "linear"}};

enum class BayerPattern { kNone, kRggb };
template <>
inline constexpr EnumNames<BayerPattern> kEnumNames<BayerPattern>{{BayerPattern::kNone, "none"},
                                                                  {BayerPattern::kRggb, "rggb"}};

/// What only model emva1288 has. Defaults: the class of a 3.75 um CMOS sensor.
struct EmvaConfig {
  double quantum_efficiency = 0.6;
  double photons_at_white = 0;
  double dark_current_e_per_s = 10;
  double temperature_C = 25;
  double doubling_K = 8;
  double prnu = 0.01;
  double dsnu_e = 2;
  int bits = 12;
  double gain_dn_per_e = 0;
  double offset_dn = 16;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("quantum_efficiency", quantum_efficiency, InRange{0.01, 1}, "electrons a photon");
    v.Field("photons_at_white", photons_at_white, InRange{0, 1e8},
            "photons on a pixel that is white in the scene; 0: those that fill the well");
    v.Field("dark_current_e_per_s", dark_current_e_per_s, InRange{0, 1e6},
            "electrons without light, at 25 degrees C");
    v.Field("temperature_C", temperature_C, InRange{-60, 120}, "of the sensor");
    v.Field("doubling_K", doubling_K, InRange{1, 100}, "warming that doubles the dark current");
    v.Field("prnu", prnu, InRange{0, 0.2}, "spread of the pixels' sensitivity, relative");
    v.Field("dsnu_e", dsnu_e, InRange{0, 1000}, "spread of the pixels' dark signal, electrons");
    v.Field("bits", bits, InRange{8, 16}, "of the converter; images have 8");
    v.Field("gain_dn_per_e", gain_dn_per_e, InRange{0, 1e4},
            "grey values an electron; 0: a full well is white");
    v.Field("offset_dn", offset_dn, InRange{0, 10000}, "grey value without any electron");
  }
};

/// Photons to bytes: noise in linear light, then the transfer curve.
struct SensorConfig {
  SensorModel model = SensorModel::kFast;
  bool noise = true;
  double full_well_e = 10000;
  double read_noise_e = 8;
  EmvaConfig emva = {};
  TransferCurve transfer = TransferCurve::kSrgb;
  BayerPattern bayer = BayerPattern::kNone;
  bool grey = false;
  int jpeg_quality = 0;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("model", model, AnyEnum{}, "how much of a sensor is modelled");
    v.Field("noise", noise, AnyBool{}, "whether images are noisy");
    v.Field("full_well_e", full_well_e, InRange{100, 1e6}, "electrons at white");
    v.Field("read_noise_e", read_noise_e, InRange{0, 1000}, "read noise, electrons rms");
    v.Section("emva", emva, "model: emva1288");
    v.Field("transfer", transfer, AnyEnum{}, "from linear light to bytes");
    v.Field("bayer", bayer, AnyEnum{}, "colour filters; frames then have one value a pixel");
    v.Field("grey", grey, AnyBool{}, "luminance alone, one value a pixel");
    v.Field("jpeg_quality", jpeg_quality, InRange{0, 100}, "of compressed frames; 0: none");
  }
};

}  // namespace windhover
