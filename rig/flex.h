#pragma once

#include <array>

#include "common/config/fields.h"

namespace windhover {

/// What the bar between the cameras is made of. "Strong" and "weak": how a plate bends fore-aft.
enum class BarSectionType {
  kCfTube16x14,
  kCfTube20x18,
  kCfPlate40x3Strong,
  kCfPlate40x3Weak,
  kAlPlate40x4Weak,
  kAl2020,
  kCustom
};
template <>
inline constexpr EnumNames<BarSectionType> kEnumNames<BarSectionType>{
    {BarSectionType::kCfTube16x14, "cf_tube_16_14"},
    {BarSectionType::kCfTube20x18, "cf_tube_20_18"},
    {BarSectionType::kCfPlate40x3Strong, "cf_plate_40x3_strong"},
    {BarSectionType::kCfPlate40x3Weak, "cf_plate_40x3_weak"},
    {BarSectionType::kAlPlate40x4Weak, "al_plate_40x4_weak"},
    {BarSectionType::kAl2020, "al_2020"},
    {BarSectionType::kCustom, "custom"}};

/// A bar's cross section: what its bending, twisting and warming depend on.
struct BarSection {
  double EI_forward_Nm2 = 189;  ///< Bending stiffness fore-aft.
  double EI_up_Nm2 = 189;       ///< Bending stiffness up and down.
  double GJ_Nm2 = 27;           ///< Torsional stiffness.
  double mass_per_length_kgpm = 0.0955;
  double depth_m = 0.02;  ///< Fore-aft.
  double expansion_per_K = 1e-6;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("EI_forward_Nm2", EI_forward_Nm2, InRange{0.01, 1e7}, "bending stiffness fore-aft");
    v.Field("EI_up_Nm2", EI_up_Nm2, InRange{0.01, 1e7}, "bending stiffness up and down");
    v.Field("GJ_Nm2", GJ_Nm2, InRange{0.001, 1e7}, "torsional stiffness");
    v.Field("mass_per_length_kgpm", mass_per_length_kgpm, InRange{1e-4, 100}, "mass per length");
    v.Field("depth_m", depth_m, InRange{1e-4, 1}, "fore-aft depth");
    v.Field("expansion_per_K", expansion_per_K, InRange{-1e-4, 1e-4}, "thermal expansion");
  }
};

/// A slow random walk of the cameras' relative angles about zero, as joints slip and settle:
/// Ornstein-Uhlenbeck processes.
struct DriftConfig {
  double yaw_sigma_deg = 0, pitch_sigma_deg = 0, roll_sigma_deg = 0;
  double time_constant_s = 300;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("yaw_sigma_deg", yaw_sigma_deg, InRange{0, 10}, "standard deviation of relative yaw");
    v.Field("pitch_sigma_deg", pitch_sigma_deg, InRange{0, 10}, "the same of relative pitch");
    v.Field("roll_sigma_deg", roll_sigma_deg, InRange{0, 10}, "the same of relative roll");
    v.Field("time_constant_s", time_constant_s, InRange{1, 1e5}, "correlation time");
  }
};

/// A hard landing or knock that leaves the cameras turned against each other.
struct LandingConfig {
  double time_s = 0;
  double yaw_deg = 0, pitch_deg = 0, roll_deg = 0;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("time_s", time_s, InRange{0, 1e6}, "when it happens");
    v.Field("yaw_deg", yaw_deg, InRange{-30, 30}, "relative yaw from then on, right minus left");
    v.Field("pitch_deg", pitch_deg, InRange{-30, 30}, "the same of relative pitch");
    v.Field("roll_deg", roll_deg, InRange{-30, 30}, "the same of relative roll");
  }
};

/// The bar between the cameras and what changes its shape.
struct FlexConfig {
  bool enabled = false;
  BarSectionType section = BarSectionType::kCfTube20x18;
  BarSection custom;
  double camera_mass_kg = 0.12;
  double tip_inertia_kgm2 = 3e-5;
  double damping = 0.015;
  double frequency_hz = 0;
  double participation = 0;
  double thermal_gradient_K = 0;
  double thermal_mean_K = 0;
  DriftConfig drift;
  LandingConfig landing;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("enabled", enabled, AnyBool{}, "whether the bar changes its shape");
    v.Field("section", section, AnyEnum{}, "cross section and material of the bar");
    v.Section("custom", custom, "section: custom");
    v.Field("camera_mass_kg", camera_mass_kg, InRange{0, 10}, "at each end, lens and bracket too");
    v.Field("tip_inertia_kgm2", tip_inertia_kgm2, InRange{1e-7, 1},
            "the same, moment of inertia about the bar");
    v.Field("damping", damping, InRange{1e-4, 1}, "damping ratio of every mode");
    v.Field("frequency_hz", frequency_hz, InRange{0, 5000},
            "first bending mode of a half bar; 0: from section and mass");
    v.Field("participation", participation, InRange{0, 3},
            "its modal participation factor; 0: from section and mass");
    v.Field("thermal_gradient_K", thermal_gradient_K, InRange{-200, 200},
            "how much warmer the bar's front is than its back");
    v.Field("thermal_mean_K", thermal_mean_K, InRange{-200, 200},
            "how much warmer the bar is than when it was calibrated");
    v.Section("drift", drift, "slow random change of the relative angles");
    v.Section("landing", landing, "sudden lasting change of the relative angles");
  }
};

}  // namespace windhover
