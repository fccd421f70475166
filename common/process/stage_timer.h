#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace windhover {

/// Adds up how long the stages of a process's work take. For the process's main thread only. The
/// clock of CPU time is a call of the kernel, 0.5 us, which would be much of a stage that takes
/// less than 0.1 ms: of such calls every sixteenth asks, and they are taken for the others.
///
///     const StageTimer::Scope s = timer.Start("render");
class StageTimer {
 public:
  struct Stage {
    std::string name;
    std::int64_t n = 0;
    double wall_ms = 0;
    double cpu_ms = 0;  ///< Of every thread of the process.

    /// Of the calls whose CPU time was asked for.
    double measured_wall_ms = 0, measured_cpu_ms = 0;
    double last_wall_ms = 0;
  };

  /// Counts from its construction to its destruction.
  class Scope {
   public:
    Scope(StageTimer* timer, std::size_t stage);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    StageTimer* timer_;
    std::size_t stage_;
    bool measures_cpu_;
    std::chrono::steady_clock::time_point start_;
    double start_cpu_ms_;
  };

  [[nodiscard]] Scope Start(const std::string& stage);

  /// In the order in which they were first started.
  const std::vector<Stage>& Stages() const { return stages_; }

 private:
  std::vector<Stage> stages_;
};

}  // namespace windhover
