// Every node of a run on one in-process bus, the loop closed: what the follower's controller does
// changes what its rig sees.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/bus/channels.h"
#include "common/bus/run_log.h"
#include "common/bus/truth_channels.h"
#include "estimator/estimator_node.h"
#include "lcmtypes/annotation_t.hpp"
#include "lcmtypes/uwb_t.hpp"
#include "lcmtypes/world_truth_t.hpp"
#include "render/render_node.h"
#include "sim/sim_node.h"
#include "swarm/swarm_node.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

constexpr char kScenario[] =
    R"(description: a follower keeps 10 m from a leader that leaves and comes back
random_seed: 5
duration_s: 30
frame_rate_hz: 10
observe: truth
aircraft:
  - {id: 0, type: p600, carries_rig: true, controller: follow, position_m: [0, 0, 20],
     follow: {distance_m: 10, gain_per_s: 0.8, max_speed_mps: 5}}
  - id: 1
    controller: waypoints
    waypoints:
      - {time_s: 2, position_m: [14, 1, 20.5]}
      - {time_s: 12, position_m: [24, 4, 21]}
      - {time_s: 14, position_m: [24, 4, 21]}
      - {time_s: 24, position_m: [14, 1, 20]}
)";

template <typename Node>
struct Peer {
  std::unique_ptr<TickClient> client;
  std::unique_ptr<Node> node;
};

/// Every process of a run, as nodes on one bus.
class InProcessPeers {
 public:
  InProcessPeers(const Scenario& scenario, Bus& bus) {
    const ExecutionConfig& execution = scenario.execution;
    const AircraftConfig self = scenario.ForAircraft();
    for (int i = 0; i < execution.render_processes; ++i) {
      auto client = Client(bus, "render", i);
      const ProcessShare share{i, execution.render_processes};
      auto node = std::make_unique<RenderNode>(scenario, share, 1, *client);
      render_.push_back({std::move(client), std::move(node)});
    }
    for (int i = 0; i < execution.estimator_processes; ++i) {
      auto client = Client(bus, "estimator", i);
      const ProcessShare share{i, execution.estimator_processes};
      auto node = std::make_unique<EstimatorNode>(self, share, *client);
      estimator_.push_back({std::move(client), std::move(node)});
    }
    for (int i = 0; i < execution.swarm_processes; ++i) {
      auto client = Client(bus, "swarm", i);
      const ProcessShare share{i, execution.swarm_processes};
      auto node = std::make_unique<SwarmNode>(self, share, *client);
      swarm_.push_back({std::move(client), std::move(node)});
    }
  }

 private:
  static std::unique_ptr<TickClient> Client(Bus& bus, const char* kind, int i) {
    return std::make_unique<TickClient>(bus, fmt::format("{}-{}", kind, i), 9);
  }

  std::vector<Peer<RenderNode>> render_;
  std::vector<Peer<EstimatorNode>> estimator_;
  std::vector<Peer<SwarmNode>> swarm_;
};

class ClosedLoopTest : public testing::Test {
 protected:
  Scenario Load() const { return LoadScenario(folder_.Write("s.yaml", kScenario)); }

  // Runs it and returns the log's bytes.
  std::string Run(const Scenario& scenario) {
    Bus bus("memq://");
    const InProcessPeers peers(scenario, bus);
    SimOptions options;
    options.run_id = 9;
    options.log_file = Log();
    const RunOutcome outcome = SimNode(scenario, options, bus).Run();
    EXPECT_TRUE(outcome.valid) << outcome.culprit << ": " << outcome.reason;
    std::ifstream in(Log(), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  std::filesystem::path Log() const { return folder_.path() / "run.lcm"; }

  // Distance between both aircraft at every tick, from the last run's log.
  std::vector<double> Separations_m() const {
    std::vector<double> separations_m;
    RunLogReader reader(Log());
    while (const auto event = reader.Next()) {
      if (event->channel != channel::kUavTruth) continue;
      const auto truth = reader.DecodeEvent<world_truth_t>(*event);
      separations_m.push_back(
          (Eigen::Vector3d(truth.uavs[1].p_WB_m) - Eigen::Vector3d(truth.uavs[0].p_WB_m)).norm());
    }
    return separations_m;
  }

  TemporaryFolder folder_;
};

TEST_F(ClosedLoopTest, FollowsTheLeaderAndSettlesAtItsDistance) {
  Run(Load());
  const std::vector<double> separations_m = Separations_m();
  ASSERT_EQ(separations_m.size(), 300u);
  // The leader flies at most 1.9 m/s; the controller may lag by what it can brake away,
  // v² / (2 · 0.5 m/s²), and 15 cm are the rig's place on the aircraft.
  EXPECT_LT(*std::max_element(separations_m.begin(), separations_m.end()), 15);
  EXPECT_GT(*std::min_element(separations_m.begin(), separations_m.end()), 6);
  EXPECT_NEAR(separations_m.back(), 10.15, 0.1);
}

// Forces, motors and a side wind in the loop: the follower leans and lags, but keeps its leader.
TEST_F(ClosedLoopTest, ARigidBodyFollowsTheLeaderInWind) {
  Scenario scenario = Load();
  for (Aircraft& aircraft : scenario.aircraft) aircraft.dynamics = Dynamics::kRigidBody;
  scenario.wind.mean_mps = {0, 4, 0};
  scenario.wind.turbulence = Turbulence::kLight;
  const std::string log = Run(scenario);
  const std::vector<double> separations_m = Separations_m();
  EXPECT_LT(*std::max_element(separations_m.begin(), separations_m.end()), 15);
  EXPECT_GT(*std::min_element(separations_m.begin(), separations_m.end()), 6);
  EXPECT_NEAR(separations_m.back(), 10.15, 0.5);
  EXPECT_TRUE(log == Run(scenario));
}

// Three distances of the same two aircraft, 12 m apart: rig to centre, along the optical axis, and
// between antennas on a mast of 3 m and under a belly of 2 m.
TEST_F(ClosedLoopTest, RangeDepthAndUwbAreThreeNumbers) {
  Scenario scenario = Load();
  scenario.duration_s = 0.2;
  scenario.uwb.sigma_m = 0;
  scenario.aircraft[0].self.controller = Controller::kHold;
  scenario.aircraft[0].uwb_antenna_m = {0, 0, 3};
  scenario.aircraft[1].self.controller = Controller::kHold;
  scenario.aircraft[1].position_m = {12, 0.5, 20};
  scenario.aircraft[1].uwb_antenna_m = {0, 0, -2};
  Run(scenario);
  RunLogReader reader(Log());
  int n = 0;
  while (const auto event = reader.Next()) {
    if (event->channel == channel::Uwb(0)) {
      EXPECT_NEAR(reader.DecodeEvent<uwb_t>(*event).ranges.at(0).range_m, std::hypot(12, 0.5, 5),
                  1e-12);
      ++n;
    } else if (event->channel == channel::Annotation(0)) {
      const auto annotation = reader.DecodeEvent<annotation_t>(*event);
      ASSERT_EQ(annotation.targets.size(), 1u);
      EXPECT_NEAR(annotation.targets[0].range_m, std::hypot(12 - 0.15, 0.5), 1e-9);
      EXPECT_NEAR(annotation.targets[0].depth_m, 12 - 0.15, 1e-9);
      ++n;
    }
  }
  EXPECT_EQ(n, 4);
}

TEST_F(ClosedLoopTest, TheSameBytesOnAnySpreadOfProcesses) {
  const Scenario scenario = Load();
  const std::string one = Run(scenario);
  EXPECT_TRUE(one == Run(scenario));
  Scenario spread = scenario;
  spread.execution.render_processes = 2;
  spread.execution.estimator_processes = 2;
  spread.execution.swarm_processes = 2;
  EXPECT_TRUE(one == Run(spread));
}

}  // namespace
}  // namespace windhover
