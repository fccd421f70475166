#include "render/parallel_for.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace windhover {

void ParallelFor(int n_tasks, int threads, const std::function<void(int task, int worker)>& body) {
  std::vector<std::exception_ptr> errors(static_cast<std::size_t>(std::max(n_tasks, 0)));
  std::atomic<int> next = 0;
  const auto work = [&](int worker) {
    for (int task = next++; task < n_tasks; task = next++) {
      try {
        body(task, worker);
      } catch (...) {
        errors[static_cast<std::size_t>(task)] = std::current_exception();
      }
    }
  };
  {
    std::vector<std::jthread> others;
    for (int worker = 1; worker < std::min(threads, n_tasks); ++worker) {
      others.emplace_back(work, worker);
    }
    work(0);
  }
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace windhover
