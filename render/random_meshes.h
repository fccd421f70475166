#pragma once

#include "common/random/random_stream.h"
#include "render/mesh.h"

namespace windhover {

// Drawings of what no two look alike, for detectors to learn from: sizes, proportions and colours
// are drawn from `random`. All consist of closed parts; B's origin is the middle of their box.

/// A quadrotor with a wheelbase (motor to motor across) of 0.25 to 1.1 m: hull, arms in X, legs,
/// often a camera; propellers as large as fit beside each other, or less.
AircraftModel MakeRandomQuadrotor(RandomStream* random);

/// A bird of 0.4 to 2 m of span with its wings anywhere in their beat.
AircraftModel MakeRandomBird(RandomStream* random);

/// An aeroplane of 1 to 12 m of span; or a helicopter's hull with its rotor as a disc.
AircraftModel MakeRandomAeroplane(RandomStream* random);

/// A tree without ground, 2 to 6 m: trunk, branches, and leaves in lumps.
AircraftModel MakeRandomTree(RandomStream* random);

/// Up to six boxes, rods and lumps that touch each other, 0.2 to 1.5 m in all: poles, boards,
/// aerials, things that are no aircraft.
AircraftModel MakeRandomClutter(RandomStream* random);

}  // namespace windhover
