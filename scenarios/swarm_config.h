#pragma once

#include <array>

#include "common/config/fields.h"

namespace windhover {

/// Law by which aircraft with `controller: swarm` fly; kNone: as if alone.
enum class SwarmLaw { kNone, kReynolds, kOlfatiSaber, kVasarhelyi, kOrca, kPotentialField };
template <>
inline constexpr EnumNames<SwarmLaw> kEnumNames<SwarmLaw>{
    {SwarmLaw::kNone, "none"},
    {SwarmLaw::kReynolds, "reynolds"},
    {SwarmLaw::kOlfatiSaber, "olfati_saber"},
    {SwarmLaw::kVasarhelyi, "vasarhelyi"},
    {SwarmLaw::kOrca, "orca"},
    {SwarmLaw::kPotentialField, "potential_field"}};

/// Where rigs look: towards the middle of the neighbours, at the neighbour that has been out of
/// sight for longest, along the flight, or all around.
enum class YawPolicy { kNeighbours, kAttend, kVelocity, kScan };
template <>
inline constexpr EnumNames<YawPolicy> kEnumNames<YawPolicy>{{YawPolicy::kNeighbours, "neighbours"},
                                                            {YawPolicy::kAttend, "attend"},
                                                            {YawPolicy::kVelocity, "velocity"},
                                                            {YawPolicy::kScan, "scan"}};

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

/// Parameters of R. Olfati-Saber, IEEE TAC 2006, with its simulations' defaults (docs/sources.md).
struct OlfatiSaberConfig {
  double distance_m = 7;
  double reach = 1.2;
  double epsilon = 0.1;
  double bump = 0.2;
  double a = 5, b = 5;
  double gradient = 1;
  double consensus_per_s = 2;
  double navigation_per_s = 1;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("distance_m", distance_m, InRange{0.1, 1000}, "d: distance that neighbours settle at");
    v.Field("reach", reach, InRange{1.01, 10}, "r / d: neighbours beyond r do not count");
    v.Field("epsilon", epsilon, InRange{1e-4, 1}, "of the sigma-norm");
    v.Field("bump", bump, InRange{0, 0.99}, "h: share of the reach where weights are still 1");
    v.Field("a", a, InRange{1e-3, 100}, "largest attraction, over gradient");
    v.Field("b", b, InRange{1e-3, 100}, "largest repulsion, over gradient; at least a");
    v.Field("gradient", gradient, InRange{0, 100}, "c1: weight of attraction and repulsion");
    v.Field("consensus_per_s", consensus_per_s, InRange{0, 100},
            "c2: acceleration per relative velocity; 2 sqrt(c1) damps critically");
    v.Field("navigation_per_s", navigation_per_s, InRange{0, 100},
            "acceleration per deviation from the velocity of migration and goal");
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
  int max_neighbours = 10;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("radius_m", radius_m, InRange{0.01, 100}, "of an aircraft: two keep twice as much");
    v.Field("horizon_s", horizon_s, InRange{0.01, 1000}, "time for which no collision may come");
    v.Field("max_neighbours", max_neighbours, InRange{1, 100}, "the nearest that count");
  }
};

/// Artificial potential field: O. Khatib, IJRR 1986.
struct PotentialFieldConfig {
  double influence_m = 6;
  double repulsion_m4ps2 = 20;
  double body_m = 1;
  double damping_per_s = 1.5;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("influence_m", influence_m, InRange{0.1, 1000},
            "rho_0: clearance below which neighbours repel");
    v.Field("repulsion_m4ps2", repulsion_m4ps2, InRange{0, 1e6},
            "eta: acceleration away is eta (1 / rho - 1 / rho_0) / rho^2");
    v.Field("body_m", body_m, InRange{0, 100}, "distance at which the clearance rho is 0");
    v.Field("damping_per_s", damping_per_s, InRange{0.01, 100},
            "acceleration per deviation from the velocity of migration and goal");
  }
};

/// What becomes of the ranges of one's own rig: a Kalman filter for each neighbour.
struct TracksConfig {
  double gate_sigmas = 4;
  int hits = 2;
  double memory_s = 1;
  double acceleration_mps2 = 1;
  double bearing_sigma_deg = 0.15;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("gate_sigmas", gate_sigmas, InRange{0.5, 20},
            "Mahalanobis distance from a track at which a sighting is of another");
    v.Field("hits", hits, InRange{1, 20}, "sightings after which a neighbour counts");
    v.Field("memory_s", memory_s, InRange{0.05, 60}, "time without a sighting; then forgotten");
    v.Field("acceleration_mps2", acceleration_mps2, InRange{0.01, 50},
            "change of a neighbour's velocity in a second, one sigma");
    v.Field("bearing_sigma_deg", bearing_sigma_deg, InRange{0.001, 10},
            "of the direction of a sighting: of its pixels and the own attitude");
  }
};

/// Overrules the law where an aircraft could not stop in time (swarm/collision_guard.h).
struct GuardConfig {
  bool enabled = false;
  double sigmas = 2;
  double stop_m = 2.5;
  double deceleration_mps2 = 1.5;
  double gain_per_s = 1;
  double reaction_s = 0.5;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("enabled", enabled, AnyBool{}, "whether the guard may act");
    v.Field("sigmas", sigmas, InRange{0, 10}, "of its distance by which a neighbour may be nearer");
    v.Field("stop_m", stop_m, InRange{0, 100},
            "distance from a neighbour at which to have stopped");
    v.Field("deceleration_mps2", deceleration_mps2, InRange{0.01, 50},
            "braking, by which the others are thought to brake too");
    v.Field("gain_per_s", gain_per_s, InRange{0.01, 10}, "speed per metre near the end of braking");
    v.Field("reaction_s", reaction_s, InRange{0, 10}, "until braking has begun");
  }
};

/// Where one aircraft wants to be.
struct GoalConfig {
  std::array<double, 3> position_m = {0, 0, 0};
  double speed_mps = 0;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("position_m", position_m, InRange{-1e5, 1e5}, "east, north, up");
    v.Field("speed_mps", speed_mps, InRange{0, 50}, "largest speed towards it; 0: has no goal");
  }
};

/// How aircraft with `controller: swarm` fly.
struct SwarmConfig {
  SwarmLaw controller = SwarmLaw::kReynolds;
  double max_speed_mps = 2;
  double max_acceleration_mps2 = 2;
  double perception_m = 40;
  double scatter_m = 0;
  std::array<double, 3> migration_mps = {0, 0, 0};
  double alone_speed_mps = 1;
  YawPolicy yaw = YawPolicy::kNeighbours;
  double scan_radps = 0.3;
  TracksConfig tracks;
  GuardConfig guard;
  ReynoldsConfig reynolds;
  OlfatiSaberConfig olfati_saber;
  VasarhelyiConfig vasarhelyi;
  OrcaConfig orca;
  PotentialFieldConfig potential_field;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("controller", controller, AnyEnum{}, "law of flight");
    v.Field("max_speed_mps", max_speed_mps, InRange{0.01, 50}, "largest commanded speed");
    v.Field("max_acceleration_mps2", max_acceleration_mps2, InRange{0.01, 50},
            "largest change of the commanded velocity");
    v.Field("perception_m", perception_m, InRange{0.1, 1000}, "farther neighbours do not count");
    v.Field("migration_mps", migration_mps, InRange{-50, 50},
            "velocity in W that all would like to have");
    v.Field("scatter_m", scatter_m, InRange{0, 1000},
            "by up to this the seed moves each start east, north and up, or back");
    v.Field("alone_speed_mps", alone_speed_mps, InRange{0, 50},
            "largest speed of one that knows of no other");
    v.Field("yaw", yaw, AnyEnum{}, "where rigs look");
    v.Field("scan_radps", scan_radps, InRange{0, 2}, "turning of one that looks around");
    v.Section("tracks", tracks, "how neighbours are followed from frame to frame");
    v.Section("guard", guard, "stops an aircraft in time, whatever its law");
    v.Section("reynolds", reynolds, "separation, cohesion, alignment, migration");
    v.Section("olfati_saber", olfati_saber, "a lattice of neighbours, consensus of velocities");
    v.Section("vasarhelyi", vasarhelyi, "repulsion and friction");
    v.Section("orca", orca, "half-spaces of safe velocities");
    v.Section("potential_field", potential_field, "neighbours repel, the goal attracts");
  }
};

}  // namespace windhover
