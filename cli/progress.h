#pragma once

#include <chrono>
#include <string>

namespace windhover {

/// Says on stderr how far a run is: a bar with the time to go on a terminal, a line at every
/// tenth elsewhere.
class Progress {
 public:
  explicit Progress(bool on_terminal);
  ~Progress();

  /// `done` of `total` ticks are finished.
  void Update(int done, int total);

 private:
  using Clock = std::chrono::steady_clock;

  bool on_terminal_;
  bool drawn_ = false;
  int last_tenth_ = 0;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_drawn_{};
};

/// "[#####.....] 50/100 50 % 12 s to go" after `elapsed_s`; `done` > 0.
std::string ProgressText(int done, int total, double elapsed_s);

}  // namespace windhover
