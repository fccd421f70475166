#pragma once

#include <array>

#include "common/config/fields.h"

namespace windhover {

/// Law by which aircraft with `controller: swarm` fly.
enum class SwarmLaw { kReynolds, kVasarhelyi, kOrca };
template <>
inline constexpr EnumNames<SwarmLaw> kEnumNames<SwarmLaw>{{SwarmLaw::kReynolds, "reynolds"},
                                                          {SwarmLaw::kVasarhelyi, "vasarhelyi"},
                                                          {SwarmLaw::kOrca, "orca"}};

/// Gains of Reynolds' flocking; defaults of F. Schilling et al., RA-L 2021 (docs/sources.md).
struct ReynoldsConfig {
  double separation_m2ps = 7;
  double cohesion_per_s = 1;
  double alignment = 0;
  double migration = 1;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("separation_m2ps", separation_m2ps, InRange{0, 1e4},
            "speed away from a neighbour, times its distance");
    v.Field("cohesion_per_s", cohesion_per_s, InRange{0, 100},
            "speed towards a neighbour, per metre of distance");
    v.Field("alignment", alignment, InRange{0, 100}, "share of the neighbours' mean velocity");
    v.Field("migration", migration, InRange{0, 100}, "share of migration_mps");
  }
};

/// Parameters of G. Vásárhelyi et al., Science Robotics 2018, with its authors' defaults
/// (docs/sources.md).
struct VasarhelyiConfig {
  double repulsion_m = 25.67;
  double repulsion_per_s = 0.4;
  double friction_reach_m = 10;
  double friction = 0.0238;
  double friction_slack_mps = 0.5;
  double friction_gain_per_s = 0.4;
  double friction_mps2 = 2.5;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("repulsion_m", repulsion_m, InRange{0, 1000}, "distance below which neighbours repel");
    v.Field("repulsion_per_s", repulsion_per_s, InRange{0, 100},
            "speed away, per metre that is missing");
    v.Field("friction_reach_m", friction_reach_m, InRange{0, 1000},
            "beyond repulsion_m: where velocities begin to be matched");
    v.Field("friction", friction, InRange{0, 100}, "share of the excess of relative velocity");
    v.Field("friction_slack_mps", friction_slack_mps, InRange{0, 100},
            "relative velocity that is always allowed");
    v.Field("friction_gain_per_s", friction_gain_per_s, InRange{0, 100},
            "slope of the braking curve near its end");
    v.Field("friction_mps2", friction_mps2, InRange{1e-3, 100},
            "deceleration of the braking curve");
  }
};

/// Optimal reciprocal collision avoidance: J. van den Berg et al., ISRR 2011.
struct OrcaConfig {
  double radius_m = 1.5;
  double horizon_s = 10;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("radius_m", radius_m, InRange{0.01, 100}, "of an aircraft: two keep twice as much");
    v.Field("horizon_s", horizon_s, InRange{0.01, 1000}, "time for which no collision may come");
  }
};

/// How aircraft with `controller: swarm` fly.
struct SwarmConfig {
  SwarmLaw controller = SwarmLaw::kReynolds;
  double max_speed_mps = 2;
  double max_acceleration_mps2 = 2;
  double perception_m = 40;
  std::array<double, 3> migration_mps = {0, 0, 0};
  ReynoldsConfig reynolds;
  VasarhelyiConfig vasarhelyi;
  OrcaConfig orca;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("controller", controller, AnyEnum{}, "law of flight");
    v.Field("max_speed_mps", max_speed_mps, InRange{0.01, 50}, "largest commanded speed");
    v.Field("max_acceleration_mps2", max_acceleration_mps2, InRange{0.01, 50},
            "largest change of the commanded velocity");
    v.Field("perception_m", perception_m, InRange{0.1, 1000}, "farther neighbours do not count");
    v.Field("migration_mps", migration_mps, InRange{-50, 50},
            "velocity in W that all would like to have");
    v.Section("reynolds", reynolds, "separation, cohesion, alignment, migration");
    v.Section("vasarhelyi", vasarhelyi, "repulsion and friction");
    v.Section("orca", orca, "half-planes of safe velocities");
  }
};

}  // namespace windhover
