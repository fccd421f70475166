#pragma once

#include "render/mesh.h"
#include "scenarios/scenario.h"

namespace windhover {

/// DJI Matrice 200 from its published dimensions: 887 × 880 × 378 mm with propellers, 643 mm
/// wheelbase, 432 mm propellers (docs/sources.md); our own drawing. `orange`: the shell's colour,
/// otherwise near black.
AircraftModel MakeM200(bool orange);

/// AMOVLAB Prometheus P600 from its measured dimensions: 470 × 470 × 392 mm without
/// propellers, motors at (±212.1, ±212.1) mm, 388 mm propellers (docs/sources.md); our own drawing.
AircraftModel MakeP600();

/// Aircraft that no detector of ours learns from, to try them by; our own drawings, about as large
/// as an M200. A hexacopter of 550 mm from motor to motor across, with 254 mm propellers; and a
/// tailless glider of foam, 860 mm of span.
AircraftModel MakeHexacopter();
AircraftModel MakeFlyingWing();

/// What `aircraft` looks like; reads its mesh file if it is of type mesh.
/// @throws ConfigError if the mesh cannot be used.
AircraftModel MakeAircraftModel(const Aircraft& aircraft);

}  // namespace windhover
