#include "sim/world.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "common/geometry/rotation.h"
#include "common/random/random_stream.h"
#include "lcmtypes/uav_truth_t.hpp"

namespace windhover {
namespace {

constexpr double kLargestCommand_mps = 100, kLargestCommand_radps = 100;

void CopyTo(const Eigen::Vector3d& v, double* out) { std::copy_n(v.data(), 3, out); }

// An aircraft as the seed starts it: one of the swarm begins somewhere near its place.
Aircraft Started(Aircraft aircraft, const Scenario& scenario) {
  const double scatter_m = scenario.swarm.scatter_m;
  if (aircraft.self.controller != Controller::kSwarm || scatter_m == 0) return aircraft;
  RandomStream random(scenario.random_seed, fmt::format("uav{}/start", aircraft.self.id));
  for (double& x_m : aircraft.position_m) x_m += random.Uniform(-scatter_m, scatter_m);
  return aircraft;
}

}  // namespace

int NumberOfTicks(const Scenario& scenario) {
  return std::max(1, static_cast<int>(std::lround(scenario.duration_s * scenario.frame_rate_hz)));
}

void SetState(const Kinematics& state, uav_truth_t* truth) {
  CopyTo(state.p_WB_m, truth->p_WB_m);
  CopyTo(state.v_WB_mps, truth->v_WB_mps);
  CopyTo(state.a_WB_mps2, truth->a_WB_mps2);
  CopyTo(state.w_WB_B_radps, truth->w_WB_B_radps);
  truth->qw = state.q_WB.w();
  truth->qx = state.q_WB.x();
  truth->qy = state.q_WB.y();
  truth->qz = state.q_WB.z();
}

World::World(const Scenario& scenario) {
  const double end_s = (NumberOfTicks(scenario) - 1) / scenario.frame_rate_hz;
  for (const Aircraft& given : scenario.aircraft) {
    const Aircraft aircraft = Started(given, scenario);
    const std::string name = fmt::format("uav{}", aircraft.self.id);
    bodies_.push_back(
        {aircraft.self.id, MakePath(aircraft, end_s), nullptr,
         CommandedFlight(Eigen::Vector3d(aircraft.position_m.data()), RadFromDeg(aircraft.yaw_deg)),
         FlightCommand{}, Rotors(aircraft.type, scenario.random_seed, name), Kinematics{},
         RotorsTurning{}, std::nullopt});
    Body& body = bodies_.back();
    if (aircraft.dynamics == Dynamics::kRigidBody) {
      body.rigid = std::make_unique<RigidFlight>(aircraft, scenario.wind, scenario.random_seed,
                                                 body.path.get());
      body.state = body.rigid->State();
      body.turning = body.rigid->Turning();
    } else {
      body.state = body.path ? body.path->At(0) : body.flight.State();
      body.turning = body.rotors.Turning();
    }
    if (aircraft.self.carries_rig && scenario.flex.enabled) {
      body.bar.emplace(scenario, aircraft.self.id, body.state, body.turning);
    }
  }
}

void World::AdvanceTo(Utime utime) {
  if (utime < utime_) throw std::logic_error("the world cannot go back in time");
  if (utime == utime_) return;
  for (Body& body : bodies_) {
    Advance(body, utime_, utime);
    if (body.bar) body.bar->AdvanceTo(SecondsFromUtime(utime), body.state, body.turning);
  }
  utime_ = utime;
}

void World::Advance(Body& body, Utime from, Utime to) {
  if (body.rigid) {
    body.rigid->AdvanceTo(to, body.command);
    body.state = body.rigid->State();
    body.turning = body.rigid->Turning();
    return;
  }
  const double duration_s = SecondsFromUtime(to - from);
  if (body.path) {
    body.state = body.path->At(SecondsFromUtime(to));
  } else {
    body.flight.Advance(duration_s, body.command);
    body.state = body.flight.State();
  }
  body.rotors.Advance(duration_s, body.state);
  body.turning = body.rotors.Turning();
}

void World::Command(int position, const FlightCommand& command) {
  if (!(command.v_WB_mps.norm() <= kLargestCommand_mps) ||
      !(std::abs(command.yaw_rate_radps) <= kLargestCommand_radps)) {
    throw std::invalid_argument(fmt::format(
        "a velocity command must be finite and at most {} m/s and {} rad/s (found [{}, {}, {}] "
        "m/s, {} rad/s)",
        kLargestCommand_mps, kLargestCommand_radps, command.v_WB_mps.x(), command.v_WB_mps.y(),
        command.v_WB_mps.z(), command.yaw_rate_radps));
  }
  bodies_[position].command = command;
}

std::vector<Kinematics> World::States() const {
  std::vector<Kinematics> states;
  for (const Body& body : bodies_) states.push_back(body.state);
  return states;
}

world_truth_t World::Truth() const {
  world_truth_t truth{};
  truth.utime = utime_;
  truth.n_uavs = size();
  for (const Body& body : bodies_) {
    uav_truth_t uav{};
    uav.id = body.id;
    SetState(body.state, &uav);
    std::copy_n(body.turning.phase_rev.begin(), 4, uav.rotor_phase_rev);
    std::copy_n(body.turning.rate_hz.begin(), 4, uav.rotor_rate_hz);
    if (body.bar) {
      const auto values = ValuesOf(body.bar->State());
      uav.modal_state.assign(values.begin(), values.end());
      uav.n_modal = static_cast<std::int32_t>(values.size());
    }
    truth.uavs.push_back(std::move(uav));
  }
  return truth;
}

}  // namespace windhover
