#include "common/process/stage_timer.h"

#include <algorithm>
#include <ctime>

namespace windhover {
namespace {

constexpr double kShort_ms = 0.1;
constexpr std::int64_t kMeasuredOf = 16;

double ProcessCpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

}  // namespace

StageTimer::Scope::Scope(StageTimer* timer, std::size_t stage)
    : timer_(timer),
      stage_(stage),
      measures_cpu_(timer->stages_[stage].n % kMeasuredOf == 0 ||
                    timer->stages_[stage].last_wall_ms >= kShort_ms),
      start_(std::chrono::steady_clock::now()),
      start_cpu_ms_(measures_cpu_ ? ProcessCpu_ms() : 0) {}

StageTimer::Scope::~Scope() {
  const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start_;
  Stage& stage = timer_->stages_[stage_];
  ++stage.n;
  stage.wall_ms += wall.count();
  stage.last_wall_ms = wall.count();
  double cpu_ms = 0;
  if (measures_cpu_) {
    cpu_ms = ProcessCpu_ms() - start_cpu_ms_;
    stage.measured_wall_ms += wall.count();
    stage.measured_cpu_ms += cpu_ms;
  } else if (stage.measured_wall_ms > 0) {
    cpu_ms = wall.count() * stage.measured_cpu_ms / stage.measured_wall_ms;
  }
  stage.cpu_ms += cpu_ms;
}

StageTimer::Scope StageTimer::Start(const std::string& stage) {
  const auto found = std::find_if(stages_.begin(), stages_.end(),
                                  [&](const Stage& entry) { return entry.name == stage; });
  const auto index = static_cast<std::size_t>(found - stages_.begin());
  if (found == stages_.end()) stages_.push_back({.name = stage});
  return {this, index};
}

}  // namespace windhover
