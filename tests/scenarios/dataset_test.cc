#include "scenarios/dataset.h"

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace windhover {
namespace {

const std::string kPresets = std::string(WINDHOVER_SOURCE_DIR) + "/scenarios/presets/";
constexpr Split kSplits[] = {Split::kTrain, Split::kVal, Split::kTest};

Scenario Preset(const std::string& name) {
  return LoadScenario(kPresets + name + ".yaml", {"description=x", "aircraft=[{id: 0}]"});
}

// The target's waypoints in the rig's axes; the observer holds its place.
std::vector<Eigen::Vector3d> PathInRig(const Scenario& flight) {
  const Aircraft& observer = flight.aircraft.at(0);
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
  X_WB.translation() = Eigen::Vector3d(observer.position_m.data());
  const Eigen::Isometry3d X_RW = (X_WB * flight.rig.calibrated.X_BR()).inverse();
  std::vector<Eigen::Vector3d> path_m;
  for (const Waypoint& waypoint : flight.aircraft.at(1).waypoints) {
    path_m.push_back(X_RW * Eigen::Vector3d(waypoint.position_m.data()));
  }
  return path_m;
}

TEST(Dataset, HasThePapersPairsInFlightsOfTheirOwn) {
  const Scenario base = Preset("uavde_12mm");
  std::set<std::uint64_t> seeds;
  int n_flights = 0;
  for (const Split split : kSplits) {
    int n_pairs = 0;
    for (int i = 0; i < base.dataset.Of(split).flights; ++i, ++n_flights) {
      const Scenario flight = DatasetFlight(base, split, i, 1);
      n_pairs += static_cast<int>(std::lround(flight.duration_s * flight.frame_rate_hz));
      seeds.insert(flight.random_seed);
      EXPECT_EQ(ResolvedYaml(flight, PathStyle::kAsGiven),
                ResolvedYaml(DatasetFlight(base, split, i, 1), PathStyle::kAsGiven));
      const bool is_train = split == Split::kTrain;
      EXPECT_EQ(flight.environment.type != EnvironmentType::kBasketballCourt, is_train);
      // What a run writes into its header must be readable.
      EXPECT_NO_THROW(ScenarioFromYaml(LogHeaderYaml(flight), "flight"));
    }
    EXPECT_EQ(n_pairs, base.dataset.Of(split).pairs);
  }
  EXPECT_EQ(n_flights, 18);
  EXPECT_EQ(seeds.size(), 18U);
  EXPECT_NE(DatasetFlight(base, Split::kTest, 0, 2).random_seed,
            DatasetFlight(base, Split::kTest, 0, 1).random_seed);
}

// Waypoints are equally far apart in time, so their distances are those of the pairs.
TEST(Dataset, DistancesAreAsUniformAsThePapers) {
  const Scenario base = Preset("uavde_12mm_nominal");
  for (const Split split : kSplits) {
    const SplitConfig& config = base.dataset.Of(split);
    int n = 0, near = 0, nearest = 0, farthest = 0;
    for (int i = 0; i < config.flights; ++i) {
      for (const Eigen::Vector3d& p_R_m : PathInRig(DatasetFlight(base, split, i, 1))) {
        const double distance_m = p_R_m.norm();
        // The bearing adds at most 3 % to the depth, which is what the limits are of.
        EXPECT_GE(distance_m, 4.3);
        EXPECT_LE(distance_m, 41 * 1.03);
        ++n;
        near += distance_m < 20;
        nearest += distance_m < 12.15;
        farthest += distance_m > 30.5;
      }
    }
    // Manoeuvres of 0.5 m along the line of sight blur the borders by 0.5 / 16.
    EXPECT_NEAR(1.0 * near / n, config.near_share, 0.03);
    EXPECT_NEAR(1.0 * nearest / n, config.near_share / 2, 0.03);
    EXPECT_NEAR(1.0 * farthest / n, (1 - config.near_share) / 2, 0.03);
  }
}

// The disc of the M200's propellers and its height, seen through the rig with its offset.
TEST(Dataset, BothCamerasSeeAllOfTheTarget) {
  for (const char* preset : {"uavde_12mm", "uavde_16mm"}) {
    const Scenario base = Preset(preset);
    const PosedStereoRig rig = Misaligned(base.rig.calibrated.ToStereoRig(), base.rig.misalignment);
    for (int i = 0; i < 12; ++i) {
      for (const Eigen::Vector3d& p_R_m : PathInRig(DatasetFlight(base, Split::kTrain, i, 1))) {
        for (const double side_m : {-0.45, 0.45}) {
          const auto seen = Project(rig, p_R_m + Eigen::Vector3d(side_m, 0, 0));
          ASSERT_TRUE(seen);
          EXPECT_GT(std::min(seen->left_px.x(), seen->right_px.x()), 0) << p_R_m.z();
          EXPECT_LT(std::max(seen->left_px.x(), seen->right_px.x()), 1279) << p_R_m.z();
          EXPECT_GT(seen->left_px.y(), 0);
          EXPECT_LT(seen->left_px.y(), 719);
        }
      }
    }
  }
}

// Tilt is acceleration by gravity; second differences see 0.95 of a sine of 2 s.
TEST(Dataset, TargetTiltsAsWanted) {
  const Scenario base = Preset("uavde_12mm");
  double forward2 = 0, right2 = 0;
  int n = 0;
  for (int i = 0; i < 12; ++i) {
    const Scenario flight = DatasetFlight(base, Split::kTrain, i, 1);
    const auto path_m = PathInRig(flight);
    const double h_s = flight.aircraft[1].waypoints[1].time_s;
    for (std::size_t k = 1; k + 1 < path_m.size(); ++k, ++n) {
      const Eigen::Vector3d a_mps2 = (path_m[k - 1] - 2 * path_m[k] + path_m[k + 1]) / (h_s * h_s);
      forward2 += a_mps2.z() * a_mps2.z();
      right2 += a_mps2.x() * a_mps2.x();
    }
  }
  const double tilt_deg = std::atan(std::sqrt((forward2 + right2) / 2 / n) / 9.81) * 180 / M_PI;
  EXPECT_NEAR(tilt_deg, base.dataset.tilt_deg, 0.25 * base.dataset.tilt_deg);
}

TEST(Dataset, TakesTheTargetOfTheScenario) {
  Scenario base = Preset("uavde_12mm");
  base.aircraft = {{}, {}};
  base.aircraft[0].self = {
      .id = 3, .carries_rig = false, .controller = {}, .follow = {}, .goal = {}};
  base.aircraft[0].type = AircraftType::kP600;
  base.aircraft[1].self = {
      .id = 5, .carries_rig = true, .controller = {}, .follow = {}, .goal = {}};
  base.aircraft[1].type = AircraftType::kM200Black;
  const Scenario flight = DatasetFlight(base, Split::kTest, 0, 1);
  ASSERT_EQ(flight.aircraft.size(), 2U);
  EXPECT_EQ(flight.aircraft[0].type, AircraftType::kM200Black);
  EXPECT_TRUE(flight.aircraft[0].self.carries_rig);
  EXPECT_EQ(flight.aircraft[1].type, AircraftType::kP600);
}

// Everything that may be wrong is, in another way in every flight.
TEST(Dataset, PretrainDrawsEveryFlightAnew) {
  const Scenario base =
      LoadUndrawnScenario(kPresets + "pretrain.yaml", {"description=x", "aircraft=[{id: 0}]"});
  ASSERT_FALSE(base.randomize.empty());
  std::set<double> levels, skews, noises, latencies;
  std::set<BarSectionType> sections;
  const int n_flights = base.dataset.Of(Split::kTrain).flights;
  for (int i = 0; i < n_flights; ++i) {
    const Scenario flight = DatasetFlight(base, Split::kTrain, i, 1);
    EXPECT_TRUE(flight.randomize.empty());
    levels.insert(flight.vibration.level);
    skews.insert(flight.exposure.skew_ms);
    noises.insert(flight.geometric.sigma_relative);
    latencies.insert(flight.uwb.latency_s);
    sections.insert(flight.flex.section);
    EXPECT_EQ(ResolvedYaml(DatasetFlight(base, Split::kTrain, i, 1), PathStyle::kAsGiven),
              ResolvedYaml(flight, PathStyle::kAsGiven));
    // What is drawn is a scenario: it reads back, rules and all.
    EXPECT_NO_THROW(ScenarioFromYaml(ResolvedYaml(flight, PathStyle::kAsGiven), "flight"));
  }
  for (const auto& drawn : {levels, skews, noises, latencies}) {
    EXPECT_EQ(drawn.size(), static_cast<std::size_t>(n_flights));
  }
  // Ranges of the physical models: level 0 to 3, skew 0 to 33 ms, boxes 1 to 6 %.
  EXPECT_LT(*levels.rbegin(), 3);
  EXPECT_GT(*levels.rbegin(), 1.5);
  EXPECT_LT(*skews.rbegin(), 33);
  EXPECT_GT(*skews.rbegin(), 16);
  EXPECT_GE(*noises.begin(), 0.01);
  EXPECT_LE(*noises.rbegin(), 0.06);
  EXPECT_GE(sections.size(), 3U);
}

// Light and air are each flight's own, by its seed, but for what `randomize` draws.
TEST(Dataset, LooksOfFlightsDiffer) {
  Scenario base = Preset("uavde_12mm");
  std::set<double> yaws, suns, covers, visibilities, levels;
  for (int i = 0; i < 12; ++i) {
    const EnvironmentConfig look = DatasetFlight(base, Split::kTrain, i, 1).environment;
    yaws.insert(look.yaw_deg);
    suns.insert(look.sun_elevation_deg);
    covers.insert(look.cloud_cover);
    visibilities.insert(look.visibility_m);
    levels.insert(look.brightness);
  }
  for (const auto& drawn : {yaws, suns, covers, visibilities, levels}) {
    EXPECT_EQ(drawn.size(), 12U);
  }
  EXPECT_GE(*visibilities.begin(), 2000);
  base.randomize = {{.key = "environment.visibility_m", .min = 100, .max = 200, .one_of = {}}};
  const EnvironmentConfig look = DatasetFlight(base, Split::kTrain, 0, 1).environment;
  EXPECT_GE(look.visibility_m, 100);
  EXPECT_LE(look.visibility_m, 200);
  EXPECT_EQ(look.cloud_cover,
            DatasetFlight(Preset("uavde_12mm"), Split::kTrain, 0, 1).environment.cloud_cover);
}

}  // namespace
}  // namespace windhover
