#pragma once

#include <string>

#include "eval/evaluation.h"

namespace windhover {

/// How long a replay takes in the report: as long as the flight, but no more than 20 s.
double ReplayDuration_s(Utime first, Utime last);

/// The flight from above and from one side, with aircraft that move along their paths, and where
/// two of them came closest; inline <svg>. Empty without a tick.
std::string FlightViews(const RunRecord& run);

/// The smallest distance of any two aircraft over time, its least value marked; empty of one.
std::string SeparationChart(const RunRecord& run);

}  // namespace windhover
