#include "learn/geometric_flight.h"

#include <stdexcept>

#include "eval/samples.h"
#include "render/box_detector.h"
#include "render/scene_geometry.h"
#include "sim/imu_clock.h"
#include "sim/uwb_ranging.h"
#include "sim/world.h"

namespace windhover {
namespace {

void CheckAircraft(const Scenario& flight, const World& world) {
  const bool fits = flight.aircraft.size() == 2 && flight.aircraft[0].self.carries_rig &&
                    !flight.aircraft[1].self.carries_rig && !world.IsCommanded(0) &&
                    !world.IsCommanded(1);
  if (!fits) throw std::invalid_argument("a flight of a data set is one rig and one target");
}

// What a run scores of this moment, if anything.
std::optional<FlownFrame> Scored(const Scenario& flight, const annotation_t& annotation,
                                 const uwb_t& uwb, int tick) {
  const target_annotation_t& target = annotation.targets[0];
  if (!InViewOfBoth(target)) return std::nullopt;
  const auto reference_m = Reference_m(target, uwb.ranges[0].range_m, flight.score.reference);
  if (!reference_m) return std::nullopt;
  const auto& image = flight.rig.calibrated.image;
  const detection_t detection =
      DetectGeometric(annotation, flight.geometric, flight.random_seed, tick, image[0], image[1]);
  FlownFrame frame{.tick = tick,
                   .utime = annotation.utime,
                   .box = std::nullopt,
                   .reference_m = *reference_m,
                   .range_m = target.range_m};
  for (const auto& target_of : Associate(detection, annotation)) {
    if (target_of) frame.box = detection.boxes[0];
  }
  return frame;
}

}  // namespace

std::vector<FlownFrame> FlyGeometric(const Scenario& flight) {
  World world(flight);
  CheckAircraft(flight, world);
  const SceneGeometry geometry(flight, {0});
  UwbRanging uwb(flight);
  ImuClock imu(flight.nav.imu_rate_hz);
  std::vector<FlownFrame> frames;
  for (int tick = 0; tick < NumberOfTicks(flight); ++tick) {
    const Utime utime = UtimeOfTick(tick, flight.frame_rate_hz);
    while (const auto sample = imu.Next(utime)) world.AdvanceTo(sample->utime);
    world.AdvanceTo(utime);
    uwb.Observe(utime, world.States());
    const auto frame =
        Scored(flight, geometry.Annotate(world.Truth(), 0), uwb.Report(0, tick), tick);
    if (frame) frames.push_back(*frame);
  }
  return frames;
}

}  // namespace windhover
