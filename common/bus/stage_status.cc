#include "common/bus/stage_status.h"

namespace windhover {

status_t StatusOf(const std::string& process, const StageTimer& timer) {
  status_t status{};
  status.process = process;
  for (const StageTimer::Stage& stage : timer.Stages()) {
    stage_timing_t timing{};
    timing.stage = stage.name;
    timing.n = stage.n;
    timing.wall_ms = stage.wall_ms;
    timing.cpu_ms = stage.cpu_ms;
    status.stages.push_back(timing);
  }
  status.n_stages = static_cast<std::int32_t>(status.stages.size());
  return status;
}

}  // namespace windhover
