#pragma once

#include <cstdint>

#include "common/random/random_stream.h"
#include "common/time/sim_time.h"
#include "lcmtypes/imu_t.hpp"
#include "lcmtypes/nav_state_t.hpp"
#include "scenarios/scenario.h"
#include "sim/world.h"

namespace windhover {

/// What aircraft measure of themselves. Noise is a function of the scenario's
/// seed, aircraft, quantity and sample number alone, so that it is the same in any order.
class OnboardSensors {
 public:
  /// Per sample, of a consumer MEMS IMU at 200 Hz.
  static constexpr double kGyroSigma_radps = 2e-3, kAccelerometerSigma_mps2 = 0.05;

  explicit OnboardSensors(const Scenario& scenario);

  /// The aircraft at `position`'s own state as its navigation filter reports it.
  nav_state_t Nav(const World& world, int position, std::int64_t sample) const;

  /// Angular velocity and a - g in B.
  imu_t Imu(const World& world, int position, std::int64_t sample) const;

 private:
  /// Of one aircraft, each with three numbers a sample.
  struct Noise {
    int id;
    RandomStream position, velocity, angular_rate, attitude, gyro, accelerometer;
  };

  NavConfig nav_;
  std::vector<Noise> aircraft_;
};

}  // namespace windhover
