#include "learn/geometric_flight.h"

#include <algorithm>
#include <stdexcept>

#include "eval/samples.h"
#include "render/box_detector.h"
#include "render/scene_geometry.h"
#include "sim/imu_clock.h"
#include "sim/onboard_sensors.h"
#include "sim/path.h"
#include "sim/uwb_ranging.h"
#include "sim/world.h"

namespace windhover {
namespace {

void Check(const Scenario& flight, const World& world) {
  const bool fits = flight.aircraft.size() == 2 && flight.aircraft[0].self.carries_rig &&
                    !flight.aircraft[1].self.carries_rig && !world.IsCommanded(0) &&
                    !world.IsCommanded(1);
  if (!fits) throw std::invalid_argument("a flight of a data set is one rig and one target");
}

// Whether boxes and ranges depend on how the world came to where it is, and not on the time alone:
// on the phases of rotors, on a bar that rings, on what the air did.
bool HasMemory(const Scenario& flight, const world_truth_t& start) {
  const auto is_rigid = [](const Aircraft& a) { return a.dynamics == Dynamics::kRigidBody; };
  const std::vector<double>& bar = start.uavs[0].modal_state;
  const bool rests = flight.aircraft[0].self.controller == Controller::kHold &&
                     std::all_of(bar.begin(), bar.end(), [](double x) { return x == 0; });
  return std::any_of(flight.aircraft.begin(), flight.aircraft.end(), is_rigid) || !rests ||
         flight.vibration.source == VibrationSource::kRotors;
}

/// The two aircraft as time goes by; without a memory only the target moves.
class Pair {
 public:
  explicit Pair(const Scenario& flight)
      : world_(flight),
        imu_(flight.nav.imu_rate_hz),
        truth_(world_.Truth()),
        states_(world_.States()) {
    Check(flight, world_);
    if (HasMemory(flight, truth_)) return;
    target_ = MakePath(flight.aircraft[1], (NumberOfTicks(flight) - 1) / flight.frame_rate_hz);
  }

  void AdvanceTo(Utime utime) {
    if (target_ != nullptr) {
      states_[1] = target_->At(SecondsFromUtime(utime));
      SetState(states_[1], &truth_.uavs[1]);
      truth_.utime = utime;
      return;
    }
    while (const auto sample = imu_.Next(utime)) world_.AdvanceTo(sample->utime);
    world_.AdvanceTo(utime);
    truth_ = world_.Truth();
    states_ = world_.States();
  }

  const World& Observer() const { return world_; }
  const world_truth_t& Truth() const { return truth_; }
  const std::vector<Kinematics>& States() const { return states_; }

 private:
  World world_;
  ImuClock imu_;
  world_truth_t truth_;
  std::vector<Kinematics> states_;
  std::unique_ptr<Path> target_;  ///< Null: the world as a whole flies.
};

}  // namespace

struct GeometricFlight::Parts {
  Scenario flight;
  Pair pair;
  SceneGeometry geometry;
  UwbRanging uwb;
  OnboardSensors sensors;
  int n_ticks, next = 0;

  explicit Parts(const Scenario& scenario)
      : flight(scenario),
        pair(flight),
        geometry(flight, {0}),
        uwb(flight),
        sensors(flight),
        n_ticks(NumberOfTicks(flight)) {}
};

GeometricFlight::GeometricFlight(const Scenario& flight)
    : parts_(std::make_unique<Parts>(flight)) {}

GeometricFlight::~GeometricFlight() = default;

std::optional<FlownFrame> GeometricFlight::Next() {
  Parts& now = *parts_;
  if (now.next >= now.n_ticks) return std::nullopt;
  FlownFrame frame{.tick = now.next++,
                   .utime = 0,
                   .box = std::nullopt,
                   .box_is_of_target = false,
                   .reference_m = std::nullopt};
  frame.utime = UtimeOfTick(frame.tick, now.flight.frame_rate_hz);
  now.pair.AdvanceTo(frame.utime);
  now.uwb.Observe(frame.utime, now.pair.States());
  const annotation_t annotation = now.geometry.Annotate(now.pair.Truth(), 0);
  const target_annotation_t& target = annotation.targets[0];
  frame.range_m = target.range_m;
  if (InViewOfBoth(target)) {
    const double uwb_m = now.uwb.Report(0, frame.tick).ranges[0].range_m;
    frame.reference_m = Reference_m(target, uwb_m, now.flight.score.reference);
  }
  const auto& image = now.flight.rig.calibrated.image;
  const detection_t detection = DetectGeometric(
      annotation, now.flight.geometric, now.flight.random_seed, frame.tick, image[0], image[1]);
  if (detection.boxes.empty()) return frame;
  frame.box = detection.boxes[0];
  frame.box_is_of_target = Associate(detection, annotation)[0].has_value();
  return frame;
}

nav_state_t GeometricFlight::Nav() const {
  const Parts& now = *parts_;
  nav_state_t nav = now.sensors.Nav(now.pair.Observer(), 0, now.next - 1);
  nav.utime = now.pair.Truth().utime;
  return nav;
}

}  // namespace windhover
