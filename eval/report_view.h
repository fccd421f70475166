#pragma once

#include <string>

#include "eval/run_record.h"

namespace windhover {

/// What the left camera of the first aircraft with a rig saw, replayed as FlightViews() does: boxes
/// of truth (dashed, with the number of the target) and of detections (solid) in an empty image;
/// inline <svg>. Empty where it saw nothing.
std::string ObserverView(const RunRecord& run);

}  // namespace windhover
