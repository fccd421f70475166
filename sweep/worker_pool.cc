#include "sweep/worker_pool.h"

#include <atomic>
#include <csignal>
#include <map>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "scenarios/randomize.h"
#include "sweep/sweep_table.h"

namespace windhover {
namespace {

constexpr int kMaxJobs = 256;
constexpr auto kPoll = std::chrono::milliseconds(10);

/// What coordinator and workers share. Workers only count; rows go through the journal.
struct Shared {
  std::atomic<int> next{0};  ///< Of the points to be done.
  std::atomic<int> done{0};  ///< Runs that have ended, of whatever verdict.
  struct Slot {
    std::atomic<int> place{-1};   ///< Of its point in the list; -1: none.
    std::atomic<int> run{-1};     ///< Of that point; -1: none.
    std::atomic<int> counted{0};  ///< In `done`, of that point.
  };
  std::array<Slot, kMaxJobs> slots;
};
static_assert(std::atomic<int>::is_always_lock_free, "works between processes");

class SharedMemory {
 public:
  SharedMemory()
      : memory_(mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS,
                     -1, 0)) {
    if (memory_ == MAP_FAILED) throw std::runtime_error("no memory for the workers of a sweep");
    shared_ = new (memory_) Shared;
  }
  ~SharedMemory() { munmap(memory_, sizeof(Shared)); }
  SharedMemory(const SharedMemory&) = delete;
  Shared* operator->() const { return shared_; }

 private:
  void* memory_;
  Shared* shared_;
};

/// The body of one worker process.
class Worker {
 public:
  Worker(const SweepPlan& plan, const RunFunction& run, const PoolOptions& options,
         const SharedMemory& shared, int index)
      : plan_(plan),
        run_(run),
        options_(options),
        shared_(shared),
        slot_(shared->slots[static_cast<std::size_t>(index)]),
        index_(index),
        rows_(ReadJournal(options.journal)),
        journal_(options.journal) {}

  /// @param place where in the list to begin; -1: wherever is next.
  void Work(int place) {
    const int n = static_cast<int>(options_.points.size());
    for (int at = place < 0 ? shared_->next++ : place; at < n; at = shared_->next++) {
      slot_.place = at;
      DoPoint(options_.points[static_cast<std::size_t>(at)]);
      slot_.place = -1;
      if (IsStopped()) return;
    }
  }

 private:
  bool IsStopped() const { return options_.stop_requested && options_.stop_requested(); }

  void Count(int runs) {
    shared_->done += runs;
    slot_.counted += runs;
  }

  void DoPoint(int point) {
    slot_.counted = 0;
    const Scenario undrawn = plan_.ScenarioAt(static_cast<std::size_t>(point));
    const StopConfig& stop = plan_.config.stop;
    const auto metric = static_cast<std::size_t>(
        std::find(plan_.metrics.begin(), plan_.metrics.end(), stop.metric) - plan_.metrics.begin());
    std::vector<std::optional<double>> values;
    for (int i = 0; i < plan_.config.seeds.count && !IsStopped(); ++i) {
      const std::uint64_t seed = plan_.SeedOf(i);
      auto known = rows_.find({point, seed});
      if (known == rows_.end()) {
        slot_.run = i;
        RunRow row = TryRun(undrawn, point, seed);
        if (IsStopped()) return;  // It may have ended before its time.
        journal_.Append(row);
        slot_.run = -1;
        known = rows_.emplace(std::pair(point, seed), std::move(row)).first;
      }
      Count(1);
      const RunRow& row = known->second;
      values.push_back(row.valid() && metric < row.metrics.size() ? row.metrics[metric]
                                                                  : std::nullopt);
      if (!IsNarrowEnough(stop, values)) continue;
      return Count(plan_.config.seeds.count - i - 1);
    }
  }

  RunRow TryRun(const Scenario& undrawn, int point, std::uint64_t seed) {
    RunRow row;
    for (int attempt = 0; attempt <= plan_.config.retries; ++attempt) {
      try {
        Scenario scenario = undrawn;
        scenario.random_seed = seed;
        row = run_(Drawn(std::move(scenario)), static_cast<std::size_t>(point),
                   {.worker = index_, .attempt = attempt});
      } catch (const std::exception& error) {
        row = {.verdict = "invalid", .reason = error.what(), .metrics = {}};
      }
      if (row.valid() || IsStopped()) break;
    }
    row.point = point;
    row.seed = seed;
    return row;
  }

  const SweepPlan& plan_;
  const RunFunction& run_;
  const PoolOptions& options_;
  const SharedMemory& shared_;
  Shared::Slot& slot_;
  int index_;
  RunRows rows_;
  Journal journal_;
};

class Pool {
 public:
  Pool(const SweepPlan& plan, const RunFunction& run, const PoolOptions& options)
      : plan_(plan), run_(run), options_(options) {}
  Pool(const Pool&) = delete;
  ~Pool() {
    for (const auto& [pid, index] : workers_) kill(pid, SIGKILL);
    for (const auto& [pid, index] : workers_) waitpid(pid, nullptr, 0);
  }

  bool Run() {
    const int n_points = static_cast<int>(options_.points.size());
    const int n_jobs = std::min({options_.jobs, kMaxJobs, n_points});
    for (int i = 0; i < n_jobs; ++i) Start(i, -1);
    bool is_stopped = false;
    while (!workers_.empty()) {
      if (options_.on_progress) options_.on_progress(shared_->done);
      if (!is_stopped && options_.stop_requested && options_.stop_requested()) {
        is_stopped = true;
        for (const auto& [pid, index] : workers_) kill(pid, SIGTERM);
      }
      Reap(is_stopped);
      std::this_thread::sleep_for(kPoll);
    }
    return !is_stopped;
  }

 private:
  void Start(int index, int place) {
    const pid_t parent = getpid();
    std::fflush(nullptr);
    const pid_t pid = fork();
    if (pid < 0) throw std::runtime_error("cannot start a worker of the sweep");
    if (pid > 0) {
      workers_[pid] = index;
      return;
    }
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);
    int status = 0;
    try {
      Worker(plan_, run_, options_, shared_, index).Work(place);
    } catch (const std::exception& error) {
      fmt::print(stderr, "windhover: error: {}\n", error.what());
      status = 1;
    }
    std::fflush(nullptr);
    _exit(status);
  }

  void Reap(bool is_stopped) {
    for (auto worker = workers_.begin(); worker != workers_.end();) {
      int status = 0;
      if (waitpid(worker->first, &status, WNOHANG) == 0) {
        ++worker;
        continue;
      }
      const int index = worker->second;
      worker = workers_.erase(worker);
      if (is_stopped || (WIFEXITED(status) && WEXITSTATUS(status) == 0)) continue;
      if (!WIFSIGNALED(status)) throw std::runtime_error("a worker of the sweep failed");
      GoOnAfterCrash(index, WTERMSIG(status));
    }
  }

  void GoOnAfterCrash(int index, int signal) {
    Shared::Slot& slot = shared_->slots[static_cast<std::size_t>(index)];
    if (slot.place < 0) throw std::runtime_error("a worker of the sweep died outside a run");
    const int place = slot.place, run = slot.run;
    if (run >= 0 && ++crashes_[{place, run}] > plan_.config.retries) {
      Journal(options_.journal)
          .Append({.point = options_.points[static_cast<std::size_t>(place)],
                   .seed = plan_.SeedOf(run),
                   .verdict = "invalid",
                   .reason = fmt::format("its process was killed by signal {} ({})", signal,
                                         strsignal(signal)),
                   .metrics = {}});
    }
    slot.run = -1;
    shared_->done -= slot.counted;  // It begins the point again, with what the journal has.
    Start(index, place);
  }

  const SweepPlan& plan_;
  const RunFunction& run_;
  const PoolOptions& options_;
  SharedMemory shared_;
  std::map<pid_t, int> workers_;
  std::map<std::pair<int, int>, int> crashes_;
};

}  // namespace

bool RunPool(const SweepPlan& plan, const RunFunction& run, const PoolOptions& options) {
  return Pool(plan, run, options).Run();
}

}  // namespace windhover
