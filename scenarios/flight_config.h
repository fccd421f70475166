#pragma once

#include <array>

#include "common/config/fields.h"

namespace windhover {

/// What obeys the laws of motion: nothing, the path being given (kinematic), or a rigid body with
/// four rotors under its flight controller (sim/rigid_flight.h).
enum class Dynamics { kKinematic, kRigidBody };
template <>
inline constexpr EnumNames<Dynamics> kEnumNames<Dynamics>{{Dynamics::kKinematic, "kinematic"},
                                                          {Dynamics::kRigidBody, "rigid_body"}};

/// MIL-F-8785C's classes: 15, 30 and 45 kt of wind at 20 ft.
enum class Turbulence { kNone, kLight, kModerate, kSevere };
template <>
inline constexpr EnumNames<Turbulence> kEnumNames<Turbulence>{{Turbulence::kNone, "none"},
                                                              {Turbulence::kLight, "light"},
                                                              {Turbulence::kModerate, "moderate"},
                                                              {Turbulence::kSevere, "severe"}};

/// Moving air (sim/wind.h).
struct WindConfig {
  std::array<double, 3> mean_mps = {0, 0, 0};
  Turbulence turbulence = Turbulence::kNone;
  double correlation = 0;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("mean_mps", mean_mps, InRange{-30, 30}, "where the air moves: east, north, up");
    v.Field("turbulence", turbulence, AnyEnum{}, "gusts by Dryden's model (MIL-F-8785C)");
    v.Field("correlation", correlation, InRange{0, 1},
            "of the gusts at different aircraft: 0 far from each other, 1 side by side");
  }

  bool IsCalm() const {
    return mean_mps == std::array<double, 3>{} && turbulence == Turbulence::kNone;
  }
};

}  // namespace windhover
