#pragma once

#include <array>
#include <functional>
#include <vector>

#include <sys/types.h>

#include "lcmtypes/world_truth_t.hpp"
#include "render/benchmark_poses.h"
#include "scenarios/scenario.h"

namespace windhover {

struct Times {
  double cpu_s = 0;  ///< Of the whole process.
  double wall_s = 0;
};

/// A process that renders the poses of the benchmark whenever it is told to.
class BenchmarkWorker {
 public:
  /// Forks; returns when the process has rendered its first frame and each pose once.
  /// `world_at(pose)`: what it renders. @throws std::runtime_error if the process fails.
  BenchmarkWorker(const Scenario& scenario, int threads,
                  const std::function<world_truth_t(int)>& world_at);
  ~BenchmarkWorker();
  BenchmarkWorker(const BenchmarkWorker&) = delete;

  void StartRound();
  /// Waits for the round's end; times of each pose's stereo pair.
  std::array<Times, kBenchmarkPoses> EndRound();

  /// From the fork to the end of the first frame.
  Times StartUp() const { return start_up_; }
  /// Since the fork. @throws std::runtime_error if the process has failed.
  double PeakMemory_MiB();

 private:
  void Ask(char what);
  template <typename Answer>
  Answer Receive();

  pid_t pid_ = -1;
  int socket_ = -1;
  Times start_up_;
};

}  // namespace windhover
