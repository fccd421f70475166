#include "rig/half_bar.h"

#include <cmath>
#include <numbers>

namespace windhover {
namespace {

constexpr double kPi = std::numbers::pi;

// Young's and shear modulus, Pa; density, kg/m³; expansion, 1/K. Carbon: tubes and plates of
// woven and unidirectional layers, as drones are built of.
struct Material {
  double E_Pa, G_Pa, density_kgpm3, expansion_per_K;
};
constexpr Material kCarbonTube{70e9, 5e9, 1600, 1e-6};
constexpr Material kCarbonPlate{60e9, 5e9, 1600, 2e-6};
constexpr Material kAluminium{69e9, 26e9, 2700, 23.6e-6};

BarSection Tube(const Material& material, double outer_m, double inner_m) {
  const double I_m4 = kPi / 64 * (std::pow(outer_m, 4) - std::pow(inner_m, 4));
  const double area_m2 = kPi / 4 * (outer_m * outer_m - inner_m * inner_m);
  return {.EI_forward_Nm2 = material.E_Pa * I_m4,
          .EI_up_Nm2 = material.E_Pa * I_m4,
          .GJ_Nm2 = material.G_Pa * 2 * I_m4,
          .mass_per_length_kgpm = material.density_kgpm3 * area_m2,
          .depth_m = outer_m,
          .expansion_per_K = material.expansion_per_K};
}

// J of a thin plate: width · thickness³ / 3.
BarSection Plate(const Material& material, double depth_m, double height_m) {
  const double thickness_m = std::min(depth_m, height_m), width_m = std::max(depth_m, height_m);
  return {.EI_forward_Nm2 = material.E_Pa * height_m * std::pow(depth_m, 3) / 12,
          .EI_up_Nm2 = material.E_Pa * depth_m * std::pow(height_m, 3) / 12,
          .GJ_Nm2 = material.G_Pa * width_m * std::pow(thickness_m, 3) / 3,
          .mass_per_length_kgpm = material.density_kgpm3 * depth_m * height_m,
          .depth_m = depth_m,
          .expansion_per_K = material.expansion_per_K};
}

// A slotted profile of 20 mm: I = 0.70 cm⁴, 0.45 kg/m and J = 0.15 cm⁴, as makers list it.
BarSection Aluminium2020() {
  return {.EI_forward_Nm2 = kAluminium.E_Pa * 0.70e-8,
          .EI_up_Nm2 = kAluminium.E_Pa * 0.70e-8,
          .GJ_Nm2 = kAluminium.G_Pa * 0.15e-8,
          .mass_per_length_kgpm = 0.45,
          .depth_m = 0.02,
          .expansion_per_K = kAluminium.expansion_per_K};
}

// The root of a function that changes its sign once between `low` and `high`, by bisection.
template <typename Function>
double Root(double low, double high, const Function& f) {
  const bool rises = f(high) > 0;
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    ((f(middle) > 0) == rises ? high : low) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

BarSection SectionOf(const FlexConfig& flex) {
  switch (flex.section) {
    case BarSectionType::kCfTube16x14:
      return Tube(kCarbonTube, 0.016, 0.014);
    case BarSectionType::kCfTube20x18:
      return Tube(kCarbonTube, 0.020, 0.018);
    case BarSectionType::kCfPlate40x3Strong:
      return Plate(kCarbonPlate, 0.040, 0.003);
    case BarSectionType::kCfPlate40x3Weak:
      return Plate(kCarbonPlate, 0.003, 0.040);
    case BarSectionType::kAlPlate40x4Weak:
      return Plate(kAluminium, 0.004, 0.040);
    case BarSectionType::kAl2020:
      return Aluminium2020();
    case BarSectionType::kCustom:
      break;
  }
  return flex.custom;
}

HalfBar MakeHalfBar(const FlexConfig& flex, double baseline_m) {
  return {SectionOf(flex), baseline_m / 2, flex.camera_mass_kg, flex.tip_inertia_kgm2};
}

double CantileverEigenvalue(double mass_ratio) {
  // Divided by cosh β, which keeps the sign and does not overflow.
  return Root(1e-6, 1.9, [mass_ratio](double beta) {
    return 1 / std::cosh(beta) + std::cos(beta) +
           beta * mass_ratio * (std::cos(beta) * std::tanh(beta) - std::sin(beta));
  });
}

double FreeBarEigenvalue() {
  return Root(4, 5, [](double beta) { return std::cos(beta) - 1 / std::cosh(beta); });
}

double BendingFrequency_radps(const HalfBar& bar, double EI_Nm2) {
  const double beta = CantileverEigenvalue(bar.tip_mass_kg / bar.BeamMass_kg());
  return beta * beta * std::sqrt(EI_Nm2 / (bar.BeamMass_kg() * std::pow(bar.length_m, 3)));
}

double RayleighFrequency_radps(const HalfBar& bar, double EI_Nm2) {
  const double modal_mass_kg = bar.tip_mass_kg + 33.0 / 140 * bar.BeamMass_kg();
  return std::sqrt(3 * EI_Nm2 / (std::pow(bar.length_m, 3) * modal_mass_kg));
}

double TorsionFrequency_radps(const HalfBar& bar) {
  return std::sqrt(bar.section.GJ_Nm2 / (bar.length_m * bar.tip_inertia_kgm2));
}

double Participation(const HalfBar& bar) {
  return (bar.tip_mass_kg + 3.0 / 8 * bar.BeamMass_kg()) /
         (bar.tip_mass_kg + 33.0 / 140 * bar.BeamMass_kg());
}

double AngularParticipation_m(const HalfBar& bar) {
  return bar.length_m * (bar.tip_mass_kg + 11.0 / 40 * bar.BeamMass_kg()) /
         (bar.tip_mass_kg + 33.0 / 140 * bar.BeamMass_kg());
}

StaticTip StaticTipPerAcceleration(const HalfBar& bar, double EI_Nm2) {
  const double L = bar.length_m;
  return {.deflection_m = (bar.tip_mass_kg / 3 + bar.BeamMass_kg() / 8) * L * L * L / EI_Nm2,
          .slope_rad = (bar.tip_mass_kg / 2 + bar.BeamMass_kg() / 6) * L * L / EI_Nm2};
}

}  // namespace windhover
