#pragma once

#include <functional>

namespace windhover {

/// Calls `body(task, worker)` once for each task in [0, n_tasks), on up to `threads` threads;
/// `worker` in [0, threads) names the thread, so that it can have things of its own. Which
/// worker gets which task varies: results must not depend on it.
/// @throws the exception of the lowest task that threw.
void ParallelFor(int n_tasks, int threads, const std::function<void(int task, int worker)>& body);

}  // namespace windhover
