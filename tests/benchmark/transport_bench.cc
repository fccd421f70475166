// transport_bench: what the hub costs and whether it loses anything. Prints one JSON object.
//
//   loss:        stereo frames of 1280 x 720 RGB through a lock-step whose estimator is slow, with
//                lcm-logger and a viewer listening; how many each of them missed
//   round trip:  frame -> 32-byte answer, through the hub and through shared memory

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/bus/bus.h"
#include "common/bus/tick_client.h"
#include "common/process/process.h"
#include "lcmtypes/stereo_frame_t.hpp"
#include "sim/lockstep.h"
#include "tests/support/child_process.h"

namespace windhover {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kWidth_px = 1280;
constexpr int kHeight_px = 720;
constexpr std::int64_t kRunId = 1;
const std::string kStereo = "STEREO_0";

image_t ExampleImage() {
  image_t image{};
  image.width = kWidth_px;
  image.height = kHeight_px;
  image.row_stride = 3 * kWidth_px;
  image.pixelformat = image_t::PIXEL_FORMAT_RGB;
  image.size = image.row_stride * kHeight_px;
  image.data.resize(static_cast<std::size_t>(image.size));
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    image.data[i] = static_cast<std::uint8_t>(i * 2654435761u >> 13);
  }
  return image;
}

stereo_frame_t ExampleFrame() {
  stereo_frame_t frame{};
  frame.left = frame.right = ExampleImage();
  return frame;
}

double Milliseconds(Clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

// --- Loss --------------------------------------------------------------------------------------

// Counts the events on a channel in the stream that lcm-logger writes.
class LoggedEvents {
 public:
  LoggedEvents(const std::filesystem::path& fifo, const std::string& url) : fifo_(fifo) {
    std::filesystem::remove(fifo);
    if (mkfifo(fifo.c_str(), 0600) != 0) throw std::runtime_error("cannot make a FIFO");
    logger_ = std::make_unique<ChildProcess>(std::vector<std::string>{
        "lcm-logger", "--quiet", "--force", "--lcm-url=" + url, fifo.string()});
    reader_ = std::thread([this] { Read(); });
  }
  ~LoggedEvents() {
    logger_.reset();
    reader_.join();
    std::filesystem::remove(fifo_);
  }

  int n_frames() const { return n_frames_; }
  bool Started() const { return n_events_ > 0; }

 private:
  void Read() {
    std::ifstream in(fifo_, std::ios::binary);
    std::vector<char> bytes;
    char header[28];
    while (in.read(header, sizeof header)) {
      const auto word = [&](int at) {
        std::uint32_t value = 0;
        std::memcpy(&value, header + at, 4);
        return static_cast<std::size_t>(__builtin_bswap32(value));
      };
      bytes.resize(word(20) + word(24));
      in.read(bytes.data(), std::ssize(bytes));
      n_frames_ += std::string(bytes.data(), word(20)) == kStereo;
      ++n_events_;
    }
  }

  std::filesystem::path fifo_;
  std::unique_ptr<ChildProcess> logger_;
  std::atomic<int> n_frames_{0};
  std::atomic<int> n_events_{0};
  std::thread reader_;
};

void RunRender(const std::string& url) {
  Bus bus(url);
  TickClient client(bus, "render-0", kRunId);
  stereo_frame_t frame = ExampleFrame();
  client.OnTick([&](const tick_t& tick) {
    frame.utime = tick.utime;
    client.Publish(kStereo, frame);
  });
  while (!client.Ended()) {
    client.Announce();
    bus.Handle(50);
  }
}

// Usually fast, now and then far slower than a frame takes.
void RunEstimator(const std::string& url, std::atomic<int>* n_received) {
  Bus bus(url);
  TickClient client(bus, "estimator-0", kRunId);
  stereo_frame_t frame{};
  client.Require(kStereo, &frame);
  client.OnTick([&](const tick_t& tick) {
    std::this_thread::sleep_for(std::chrono::milliseconds(tick.tick % 100 == 0 ? 300 : 2));
    ++*n_received;
  });
  while (!client.Ended()) {
    client.Announce();
    bus.Handle(50);
  }
}

void RunViewer(const std::string& url, const std::atomic<bool>& stop,
               std::atomic<int>* n_received) {
  Bus bus(url);
  bus.SubscribeBytes(kStereo, [&](const std::string&, MessageBytes) { ++*n_received; });
  while (!stop) bus.Handle(50);
}

// Wall-clock time of all ticks.
double RunTicks(Lockstep* lockstep, int n_ticks) {
  const auto start = Clock::now();
  for (int k = 0; k < n_ticks; ++k) {
    tick_t tick{};
    tick.tick = k;
    tick.utime = k * 50'000;
    tick.phase = tick_t::PHASE_RUN;
    lockstep->Step(tick);
  }
  const double wall_ms = Milliseconds(Clock::now() - start);
  lockstep->End();
  return wall_ms;
}

nlohmann::json MeasureLoss(const std::string& url, int n_frames) {
  std::atomic<int> n_estimator{0};
  std::atomic<int> n_viewer{0};
  std::atomic<bool> stop{false};
  LoggedEvents logged(std::filesystem::temp_directory_path() / "windhover_bench.fifo", url);
  std::thread render(RunRender, url);
  std::thread estimator(RunEstimator, url, &n_estimator);
  std::thread viewer(RunViewer, url, std::cref(stop), &n_viewer);
  Bus bus(url);
  Lockstep lockstep(bus, kRunId, {"render-0", "estimator-0"}, 60);
  lockstep.WaitForPeers(60);
  while (!logged.Started()) {
    bus.Publish("WARM_UP", tick_t{});
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  const double wall_ms = RunTicks(&lockstep, n_frames);
  for (int i = 0; i < 200 && (logged.n_frames() < n_frames || n_viewer < n_frames); ++i) {
    bus.Publish("FLUSH", tick_t{});  // lcm-logger flushes when the next event comes
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  stop = true;
  for (std::thread* thread : {&render, &estimator, &viewer}) thread->join();
  return {{"frames", n_frames},
          {"ms_per_tick", wall_ms / n_frames},
          {"lost",
           {{"estimator", n_frames - n_estimator},
            {"viewer", n_frames - n_viewer},
            {"lcm_logger", n_frames - logged.n_frames()}}}};
}

// --- Round trip --------------------------------------------------------------------------------

nlohmann::json Percentiles(std::vector<double> times_ms) {
  std::sort(times_ms.begin(), times_ms.end());
  const auto at = [&](double share) {
    return times_ms[static_cast<std::size_t>(share * static_cast<double>(times_ms.size() - 1))];
  };
  return {{"p50", at(0.5)}, {"p99", at(0.99)}, {"min", times_ms.front()}};
}

// Times `send` until the answer has come; the first few are warm-up.
std::vector<double> RoundTrips(Bus& bus, const bool& answered, bool* clear, int n,
                               const std::function<void()>& send) {
  constexpr int kWarmUp = 10;
  std::vector<double> times_ms;
  for (int i = 0; i < n + kWarmUp; ++i) {
    *clear = false;
    const auto start = Clock::now();
    send();
    while (!answered) bus.Handle(1000);
    if (i >= kWarmUp) times_ms.push_back(Milliseconds(Clock::now() - start));
  }
  return times_ms;
}

class SharedMemory {
 public:
  explicit SharedMemory(std::size_t n_bytes) : n_bytes_(n_bytes) {
    const int fd = shm_open("/windhover_bench", O_CREAT | O_RDWR, 0600);
    if (fd < 0 || ftruncate(fd, static_cast<off_t>(n_bytes)) != 0) {
      throw std::runtime_error("no shared memory");
    }
    bytes_ = mmap(nullptr, n_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    close(fd);
    shm_unlink("/windhover_bench");
    if (bytes_ == MAP_FAILED) throw std::runtime_error("no shared memory");
  }
  SharedMemory(const SharedMemory&) = delete;
  ~SharedMemory() { munmap(bytes_, n_bytes_); }
  void* bytes() const { return bytes_; }

 private:
  std::size_t n_bytes_;
  void* bytes_;
};

// Answers each of FRAME, BYTES and DESCRIPTOR with 32 bytes on ANSWER.
void RunAnswerer(const std::string& url, const SharedMemory& shared, std::size_t n_bytes,
                 const std::atomic<bool>& stop) {
  Bus bus(url);
  std::vector<std::uint8_t> copy(n_bytes);
  const std::vector<std::uint8_t> answer(32);
  const auto reply = [&] { bus.PublishBytes("ANSWER", answer); };
  bus.Subscribe<stereo_frame_t>("FRAME", [&](const stereo_frame_t&) { reply(); });
  bus.SubscribeBytes("BYTES", [&](const std::string&, MessageBytes) { reply(); });
  bus.SubscribeBytes("DESCRIPTOR", [&](const std::string&, MessageBytes) {
    std::memcpy(copy.data(), shared.bytes(), n_bytes);
    reply();
  });
  reply();  // Ready: the subscriptions went out before this on the same connection.
  while (!stop) bus.Handle(50);
}

nlohmann::json MeasureRoundTrip(const std::string& url, int n) {
  const stereo_frame_t frame = ExampleFrame();
  const std::vector<std::uint8_t> bytes = Encode(frame);
  const std::vector<std::uint8_t> descriptor(32);
  const SharedMemory shared(bytes.size());
  std::atomic<bool> stop{false};
  bool answered = false;
  Bus bus(url);
  bus.SubscribeBytes("ANSWER", [&](const std::string&, MessageBytes) { answered = true; });
  std::thread answerer(RunAnswerer, url, std::cref(shared), bytes.size(), std::cref(stop));
  while (!answered) bus.Handle(1000);
  const auto measure = [&](const std::function<void()>& send) {
    return Percentiles(RoundTrips(bus, answered, &answered, n, send));
  };
  const auto message = measure([&] { bus.Publish("FRAME", frame); });
  const auto transport = measure([&] { bus.PublishBytes("BYTES", bytes); });
  const auto small = measure([&] { bus.PublishBytes("BYTES", descriptor); });
  const auto memory = measure([&] {
    std::memcpy(shared.bytes(), bytes.data(), bytes.size());
    bus.PublishBytes("DESCRIPTOR", descriptor);
  });
  stop = true;
  answerer.join();
  const auto ratio = [&](const nlohmann::json& a) {
    return a["p50"].get<double>() / memory["p50"].get<double>();
  };
  return {{"bytes", bytes.size()},
          {"encoded_and_decoded_ms", message},
          {"bytes_only_ms", transport},
          {"32_bytes_ms", small},
          {"shared_memory_ms", memory},
          {"ratio_to_shared_memory",
           {{"encoded_and_decoded", ratio(message)}, {"bytes_only", ratio(transport)}}}};
}

void RunBenchmark(const std::string& hub_program, int n_frames, int n_round_trips) {
  const ChildProcess hub({hub_program});
  const std::string url = hub.ReadLine();
  if (!url.starts_with("tcpq://")) throw std::runtime_error("windhover-hub does not start");
  nlohmann::json result;
  result["round_trip"] = MeasureRoundTrip(url, n_round_trips);
  result["loss"] = MeasureLoss(url, n_frames);
  hub.Signal(SIGTERM);
  result["dropped_clients"] = nlohmann::json::parse(hub.ReadLine())["dropped"];
  std::cout << result.dump(2) << "\n";
}

}  // namespace
}  // namespace windhover

int main(int argc, char** argv) {
  int n_frames = 2000;
  int n_round_trips = 300;
  const std::string hub = std::filesystem::path(argv[0]).parent_path() / "windhover-hub";
  CLI::App app("measures the hub: frames lost, round trips", "transport_bench");
  app.add_option("--frames", n_frames, "stereo frames sent while everyone listens");
  app.add_option("--round-trips", n_round_trips, "of each kind");
  return windhover::RunProgram(app, argc, argv,
                               [&] { windhover::RunBenchmark(hub, n_frames, n_round_trips); });
}
