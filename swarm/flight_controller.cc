#include "swarm/flight_controller.h"

#include "swarm/follow_controller.h"

namespace windhover {

std::unique_ptr<FlightController> MakeFlightController(const AircraftConfig& config,
                                                       const AircraftSelf& self) {
  switch (self.controller) {
    case Controller::kFollow:
      return std::make_unique<FollowController>(config, self.follow);
    case Controller::kHold:
    case Controller::kTrajectory:
    case Controller::kWaypoints:
      return nullptr;
  }
  return nullptr;
}

}  // namespace windhover
