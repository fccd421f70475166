#pragma once

#include <string>

#include "common/process/stage_timer.h"
#include "lcmtypes/status_t.hpp"

namespace windhover {

/// The stages of `timer` as the status of `process`; the other members are 0.
status_t StatusOf(const std::string& process, const StageTimer& timer);

}  // namespace windhover
