#include "sim/onboard_sensors.h"

#include <algorithm>

#include <fmt/format.h>

#include "common/geometry/rotation.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

// Three independent normal numbers, for sample number `sample` (from -1).
Vector3d NoiseOf(RandomStream stream, std::int64_t sample, double sigma) {
  stream.Seek(3 * static_cast<std::uint64_t>(sample + 1));
  const double x = stream.Normal(), y = stream.Normal(), z = stream.Normal();
  return sigma * Vector3d(x, y, z);
}

void CopyTo(const Vector3d& v, double* out) { std::copy_n(v.data(), 3, out); }

}  // namespace

OnboardSensors::OnboardSensors(const Scenario& scenario) : nav_(scenario.nav) {
  for (const Aircraft& aircraft : scenario.aircraft) {
    const int id = aircraft.self.id;
    const auto stream = [&](const char* of) {
      return RandomStream(scenario.random_seed, fmt::format("uav{}/{}", id, of));
    };
    aircraft_.push_back({id, stream("nav/position"), stream("nav/velocity"),
                         stream("nav/angular_rate"), stream("nav/attitude"), stream("imu/gyro"),
                         stream("imu/accelerometer")});
  }
}

nav_state_t OnboardSensors::Nav(const World& world, int position, std::int64_t sample) const {
  const Kinematics& state = world.State(position);
  const Noise& noise = aircraft_[static_cast<std::size_t>(position)];
  nav_state_t nav{};
  nav.utime = world.utime();
  nav.id = noise.id;
  CopyTo(state.p_WB_m + NoiseOf(noise.position, sample, nav_.position_sigma_m), nav.p_WB_m);
  CopyTo(state.v_WB_mps + NoiseOf(noise.velocity, sample, nav_.velocity_sigma_mps), nav.v_WB_mps);
  CopyTo(state.w_WB_B_radps + NoiseOf(noise.angular_rate, sample, kGyroSigma_radps),
         nav.w_WB_B_radps);
  const Vector3d turn_rad = NoiseOf(noise.attitude, sample, RadFromDeg(nav_.attitude_sigma_deg));
  const Eigen::Quaterniond q_WB =
      (state.q_WB * Eigen::Quaterniond(RotationFromVector(turn_rad))).normalized();
  nav.qw = q_WB.w();
  nav.qx = q_WB.x();
  nav.qy = q_WB.y();
  nav.qz = q_WB.z();
  return nav;
}

imu_t OnboardSensors::Imu(const World& world, int position, std::int64_t sample) const {
  const Kinematics& state = world.State(position);
  const Noise& noise = aircraft_[static_cast<std::size_t>(position)];
  imu_t imu{};
  imu.utime = world.utime();
  imu.id = noise.id;
  const Vector3d force_B_mps2 = state.q_WB.conjugate() * (state.a_WB_mps2 - GravityInWorld());
  CopyTo(state.w_WB_B_radps + NoiseOf(noise.gyro, sample, kGyroSigma_radps), imu.gyro_B_radps);
  CopyTo(force_B_mps2 + NoiseOf(noise.accelerometer, sample, kAccelerometerSigma_mps2),
         imu.specific_force_B_mps2);
  return imu;
}

}  // namespace windhover
