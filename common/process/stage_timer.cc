#include "common/process/stage_timer.h"

#include <algorithm>
#include <ctime>

namespace windhover {
namespace {

double ProcessCpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

}  // namespace

StageTimer::Scope::Scope(StageTimer* timer, std::size_t stage)
    : timer_(timer),
      stage_(stage),
      start_(std::chrono::steady_clock::now()),
      start_cpu_ms_(ProcessCpu_ms()) {}

StageTimer::Scope::~Scope() {
  const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start_;
  Stage& stage = timer_->stages_[stage_];
  ++stage.n;
  stage.wall_ms += wall.count();
  stage.cpu_ms += ProcessCpu_ms() - start_cpu_ms_;
}

StageTimer::Scope StageTimer::Start(const std::string& stage) {
  const auto found = std::find_if(stages_.begin(), stages_.end(),
                                  [&](const Stage& entry) { return entry.name == stage; });
  const auto index = static_cast<std::size_t>(found - stages_.begin());
  if (found == stages_.end()) stages_.push_back({.name = stage});
  return {this, index};
}

}  // namespace windhover
