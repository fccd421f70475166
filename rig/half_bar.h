#pragma once

#include "rig/flex.h"

namespace windhover {

/// One of the two cantilevers that the bar clamped at its middle is: length L, a camera of mass M
/// at its tip. Source: S. S. Rao, "Mechanical Vibrations", ch. 8; R. D. Blevins, "Formulas for
/// Natural Frequency and Mode Shape".
struct HalfBar {
  BarSection section;
  double length_m;
  double tip_mass_kg;
  double tip_inertia_kgm2;  ///< About the bar's axis.

  double BeamMass_kg() const { return section.mass_per_length_kgpm * length_m; }
};

/// The section that a name stands for; `custom` as it is.
BarSection SectionOf(const FlexConfig& flex);

/// @pre baseline_m > 0
HalfBar MakeHalfBar(const FlexConfig& flex, double baseline_m);

/// First root β > 0 of 1 + cos β cosh β + β μ (cos β sinh β - sin β cosh β) = 0, the eigenvalue of
/// a cantilever with tip mass, μ = M / (ρ A L) >= 0; 1.875104 for μ = 0.
double CantileverEigenvalue(double mass_ratio);

/// First root β > 0 of cos β cosh β = 1, of a bar that is free at both ends: 4.730041.
double FreeBarEigenvalue();

/// First bending mode, ω₁ = β² √(EI / (ρ A L⁴)), rad/s.
double BendingFrequency_radps(const HalfBar& bar, double EI_Nm2);

/// The same by Rayleigh's quotient with the static shape, ω₁² = 3 EI / (L³ (M + 33/140 ρ A L)):
/// 1.5 % too high without a tip mass, 0.05 % where it equals the beam's.
double RayleighFrequency_radps(const HalfBar& bar, double EI_Nm2);

/// Torsion, ω_t = √(GJ / (L J_t)), rad/s; the beam's own inertia is left out.
double TorsionFrequency_radps(const HalfBar& bar);

/// How the first mode, measured by the tip's deflection, takes part in an acceleration of the
/// root: Γ = (M + 3/8 ρ A L) / (M + 33/140 ρ A L).
double Participation(const HalfBar& bar);

/// The same for an angular acceleration about the root, in metres:
/// L (M + 11/40 ρ A L) / (M + 33/140 ρ A L).
double AngularParticipation_m(const HalfBar& bar);

/// Deflection (m) and slope (rad) of the tip under a lasting acceleration of 1 m/s² of the root:
/// M L³ / (3 EI) + ρ A L⁴ / (8 EI) and M L² / (2 EI) + ρ A L³ / (6 EI).
struct StaticTip {
  double deflection_m, slope_rad;
};
StaticTip StaticTipPerAcceleration(const HalfBar& bar, double EI_Nm2);

}  // namespace windhover
