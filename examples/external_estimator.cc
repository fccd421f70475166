// A distance estimator of your own, with stock LCM and the generated types alone: it takes the
// place of windhover-estimator for aircraft 0, in a run with `observe: geometric` or `annotated`:
//
//     windhover run SCENARIO.yaml --observe geometric --estimator "external_estimator 72.8"
//
// The number is the disparity offset, px. The steps are those of lcmtypes/README.md.
#include <cstdlib>
#include <map>
#include <string>

#include <lcm/lcm-cpp.hpp>

#include "windhover/detection_t.hpp"
#include "windhover/hello_t.hpp"
#include "windhover/range_t.hpp"
#include "windhover/status_t.hpp"
#include "windhover/tick_done_t.hpp"
#include "windhover/tick_t.hpp"

using namespace windhover;

struct Estimator {
  lcm::LCM bus{};  // LCM_DEFAULT_URL, which `run` and `replay` set.
  double offset_px = 0;
  std::map<int64_t, detection_t> detections;  // Tick and input may come in either order.
  tick_t tick{};
  bool waiting = false, ended = false;

  void OnTick(const lcm::ReceiveBuffer*, const std::string&, const tick_t* message) {
    if (message->phase == tick_t::PHASE_ROLL_CALL) return Hello(message->run_id);
    if (message->phase == tick_t::PHASE_END) return End();
    tick = *message;
    waiting = true;
    Answer();
  }

  void OnDetection(const lcm::ReceiveBuffer*, const std::string&, const detection_t* message) {
    detections[message->utime] = *message;
    Answer();
  }

  void Hello(int64_t run_id) {
    hello_t hello{};
    hello.run_id = run_id;
    hello.process = "estimator-0";
    hello.types = {{"detection_t", detection_t::getHash()}, {"range_t", range_t::getHash()}};
    hello.n_types = 2;
    hello.subscriptions = {"TICK", "DETECTION_0"};
    hello.n_subscriptions = 2;
    bus.publish("HELLO", &hello);
  }

  void End() {
    status_t status{};
    status.process = "estimator-0";
    bus.publish("STATUS_estimator-0", &status);
    ended = true;
  }

  range_estimate_t Estimate(const stereo_box_t& box) const {
    const double focal_px = 12 / 3.7325e-3, baseline_m = 0.406;
    const double disparity_px = box.left.x_px - box.right.x_px - offset_px;
    range_estimate_t estimate{};
    estimate.method = "baseline";  // One of the scenario's estimator.methods.
    estimate.status =
        disparity_px > 0 ? range_estimate_t::STATUS_OK : range_estimate_t::STATUS_NO_ESTIMATE;
    if (disparity_px <= 0) return estimate;
    estimate.range_m = estimate.p_RT_m[2] = focal_px * baseline_m / disparity_px;
    estimate.range_sigma_m = 5 * estimate.range_m / disparity_px;
    return estimate;
  }

  void Answer() {
    const auto found = detections.find(tick.utime);
    if (!waiting || found == detections.end()) return;
    waiting = false;
    range_t range{};
    range.utime = tick.utime;
    for (const stereo_box_t& box : found->second.boxes) {
      range.estimates.push_back(Estimate(box));
      range.estimates.back().detection_index = range.n_estimates++;
    }
    bus.publish("RANGE_0", &range);
    tick_done_t done{};
    done.utime = tick.utime;
    done.run_id = tick.run_id;
    done.tick = tick.tick;
    done.process = "estimator-0";
    done.channels = {{"RANGE_0", 1}};
    done.n_channels = 1;
    bus.publish("TICK_DONE", &done);
    detections.clear();
  }
};

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "--help") return 0;  // See above.
  Estimator estimator;
  if (argc > 1) estimator.offset_px = std::strtod(argv[1], nullptr);
  if (!estimator.bus.good()) return 1;
  estimator.bus.subscribe("TICK", &Estimator::OnTick, &estimator);
  estimator.bus.subscribe("DETECTION_0", &Estimator::OnDetection, &estimator);
  while (!estimator.ended && estimator.bus.handle() == 0) continue;
  return estimator.ended ? 0 : 1;
}
