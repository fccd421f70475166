#include "render/benchmark_worker.h"

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "render/stereo_renderer.h"

namespace windhover {
namespace {

// What a worker is asked for.
constexpr char kRound = 'r', kPeakMemory = 'm';

using PoseTimes = std::array<Times, kBenchmarkPoses>;

Times Now() {
  timespec cpu{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu);
  const auto wall = std::chrono::steady_clock::now().time_since_epoch();
  return {static_cast<double>(cpu.tv_sec) + 1e-9 * static_cast<double>(cpu.tv_nsec),
          std::chrono::duration<double>(wall).count()};
}

Times Since(const Times& start) {
  const Times now = Now();
  return {now.cpu_s - start.cpu_s, now.wall_s - start.wall_s};
}

bool Read(int socket, void* bytes, std::size_t n) {
  ssize_t got = 0;
  do {
    got = recv(socket, bytes, n, MSG_WAITALL);
  } while (got < 0 && errno == EINTR);
  return got == static_cast<ssize_t>(n);
}

template <typename Value>
void Write(int socket, const Value& value) {
  static_assert(std::is_trivially_copyable_v<Value>);
  if (send(socket, &value, sizeof value, MSG_NOSIGNAL) != static_cast<ssize_t>(sizeof value)) {
    throw std::runtime_error("benchmark: a process has gone");
  }
}

double PeakOfThisProcess_MiB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

PoseTimes RenderPoses(StereoRenderer* renderer, const std::vector<world_truth_t>& worlds) {
  PoseTimes times;
  for (std::size_t i = 0; i < worlds.size(); ++i) {
    const Times start = Now();
    for (RenderedPair& pair : renderer->Render(worlds[i], static_cast<int>(i))) {
      renderer->Recycle(std::move(pair.left.pixels));
      renderer->Recycle(std::move(pair.right.pixels));
    }
    times[i] = Since(start);
  }
  return times;
}

// Ends when the other side closes its socket.
void Work(int socket, const Scenario& scenario, int threads,
          const std::function<world_truth_t(int)>& world_at) {
  const Times start = {.cpu_s = 0, .wall_s = Now().wall_s};
  std::vector<world_truth_t> worlds;
  for (int i = 0; i < kBenchmarkPoses; ++i) worlds.push_back(world_at(i));
  StereoRenderer renderer(scenario, {0}, threads);
  renderer.Render(worlds[0], 0);
  const Times start_up = Since(start);
  RenderPoses(&renderer, worlds);
  Write(socket, start_up);
  for (char what = 0; Read(socket, &what, 1);) {
    if (what == kRound) Write(socket, RenderPoses(&renderer, worlds));
    if (what == kPeakMemory) Write(socket, PeakOfThisProcess_MiB());
  }
}

[[noreturn]] void RunChild(int socket, const Scenario& scenario, int threads,
                           const std::function<world_truth_t(int)>& world_at) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  int status = 0;
  try {
    Work(socket, scenario, threads, world_at);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "benchmark: %s\n", error.what());
    status = 3;
  }
  _exit(status);
}

}  // namespace

BenchmarkWorker::BenchmarkWorker(const Scenario& scenario, int threads,
                                 const std::function<world_truth_t(int)>& world_at) {
  int sockets[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0) {
    throw std::runtime_error("benchmark: no socket pair");
  }
  pid_ = fork();
  if (pid_ == 0) {
    close(sockets[0]);
    RunChild(sockets[1], scenario, threads, world_at);
  }
  close(sockets[1]);
  socket_ = sockets[0];
  if (pid_ < 0) throw std::runtime_error("benchmark: cannot fork");
  start_up_ = Receive<Times>();
}

BenchmarkWorker::~BenchmarkWorker() {
  close(socket_);
  if (pid_ <= 0) return;
  kill(pid_, SIGKILL);
  while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

void BenchmarkWorker::Ask(char what) { Write(socket_, what); }

template <typename Answer>
Answer BenchmarkWorker::Receive() {
  Answer answer;
  if (!Read(socket_, &answer, sizeof answer)) {
    throw std::runtime_error("benchmark: a process has failed");
  }
  return answer;
}

void BenchmarkWorker::StartRound() { Ask(kRound); }

std::array<Times, kBenchmarkPoses> BenchmarkWorker::EndRound() { return Receive<PoseTimes>(); }

double BenchmarkWorker::PeakMemory_MiB() {
  Ask(kPeakMemory);
  return Receive<double>();
}

}  // namespace windhover
