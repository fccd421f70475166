#include "cli/progress.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>

namespace windhover {

std::string ProgressText(int done, int total, double elapsed_s) {
  constexpr int kWidth = 30;
  const int filled = kWidth * done / std::max(total, 1);
  const double to_go_s = elapsed_s * (total - done) / std::max(done, 1);
  return fmt::format("[{}{}] {}/{} {:3} % {:.0f} s to go",
                     std::string(static_cast<std::size_t>(filled), '#'),
                     std::string(static_cast<std::size_t>(kWidth - filled), '.'), done, total,
                     100 * done / std::max(total, 1), to_go_s);
}

Progress::Progress(bool on_terminal) : on_terminal_(on_terminal) {}

Progress::~Progress() {
  if (drawn_) fmt::print(stderr, "\n");
}

void Progress::Update(int done, int total) {
  using Seconds = std::chrono::duration<double>;
  const auto now = Clock::now();
  const double elapsed_s = Seconds(now - start_).count();
  const int tenth = 10 * done / std::max(total, 1);
  if (on_terminal_) {
    if (done < total && now - last_drawn_ < std::chrono::milliseconds(100)) return;
    last_drawn_ = now;
    drawn_ = true;
    fmt::print(stderr, "\r{}\x1b[K", ProgressText(done, total, elapsed_s));
    std::fflush(stderr);
  } else if (tenth > last_tenth_) {
    last_tenth_ = tenth;
    fmt::print(stderr, "windhover: {}\n", ProgressText(done, total, elapsed_s));
  }
}

}  // namespace windhover
