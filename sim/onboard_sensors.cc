#include "sim/onboard_sensors.h"

#include <algorithm>

#include <fmt/format.h>

#include "common/geometry/rotation.h"
#include "common/random/random_stream.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

// Three independent normal numbers, for sample number `sample` (from -1) of the stream `name`.
Vector3d Noise(std::uint64_t seed, const std::string& name, std::int64_t sample, double sigma) {
  RandomStream stream(seed, name);
  stream.Seek(3 * static_cast<std::uint64_t>(sample + 1));
  const double x = stream.Normal(), y = stream.Normal(), z = stream.Normal();
  return sigma * Vector3d(x, y, z);
}

void CopyTo(const Vector3d& v, double* out) { std::copy_n(v.data(), 3, out); }

}  // namespace

OnboardSensors::OnboardSensors(const Scenario& scenario)
    : seed_(scenario.random_seed), nav_(scenario.nav) {
  for (const Aircraft& aircraft : scenario.aircraft) ids_.push_back(aircraft.self.id);
}

nav_state_t OnboardSensors::Nav(const World& world, int position, std::int64_t sample) const {
  const Kinematics& state = world.State(position);
  const auto noise = [&](const char* of, double sigma) {
    return Noise(seed_, fmt::format("uav{}/nav/{}", ids_[position], of), sample, sigma);
  };
  nav_state_t nav{};
  nav.utime = world.utime();
  nav.id = ids_[position];
  CopyTo(state.p_WB_m + noise("position", nav_.position_sigma_m), nav.p_WB_m);
  CopyTo(state.v_WB_mps + noise("velocity", nav_.velocity_sigma_mps), nav.v_WB_mps);
  CopyTo(state.w_WB_B_radps + noise("angular_rate", kGyroSigma_radps), nav.w_WB_B_radps);
  const Vector3d turn_rad = noise("attitude", RadFromDeg(nav_.attitude_sigma_deg));
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
  const auto noise = [&](const char* of, double sigma) {
    return Noise(seed_, fmt::format("uav{}/imu/{}", ids_[position], of), sample, sigma);
  };
  imu_t imu{};
  imu.utime = world.utime();
  imu.id = ids_[position];
  const Vector3d force_B_mps2 = state.q_WB.conjugate() * (state.a_WB_mps2 - GravityInWorld());
  CopyTo(state.w_WB_B_radps + noise("gyro", kGyroSigma_radps), imu.gyro_B_radps);
  CopyTo(force_B_mps2 + noise("accelerometer", kAccelerometerSigma_mps2),
         imu.specific_force_B_mps2);
  return imu;
}

}  // namespace windhover
