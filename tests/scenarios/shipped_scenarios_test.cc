#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rig/rig_motion.h"
#include "scenarios/scenario.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

const fs::path kScenarios = fs::path(WINDHOVER_SOURCE_DIR) / "scenarios";

TEST(ShippedScenarios, AllLoadAndReadBack) {
  int n = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(kScenarios)) {
    if (entry.path().extension() != ".yaml") continue;
    SCOPED_TRACE(entry.path());
    const Scenario scenario = LoadScenario(entry.path());
    const std::string text = ResolvedYaml(scenario, PathStyle::kAsGiven);
    EXPECT_EQ(ResolvedYaml(ScenarioFromYaml(text, "resolved"), PathStyle::kAsGiven), text);
    EXPECT_FALSE(scenario.expect.empty()) << "a scenario without a gate cannot fail";
    ++n;
  }
  EXPECT_GE(n, 4);
}

TEST(ShippedScenarios, AllPresetsMakeAScenario) {
  int n = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(kScenarios / "presets")) {
    SCOPED_TRACE(entry.path());
    EXPECT_NO_THROW(LoadScenario(entry.path(), {"description=x", "aircraft=[{id: 1}]"}));
    ++n;
  }
  EXPECT_GE(n, 5);
}

Scenario Preset(const std::string& name) {
  return LoadScenario(kScenarios / "presets" / (name + ".yaml"),
                      {"description=x", "aircraft=[{id: 1}]"});
}

// The bar's mode is the blade pass of a P600 that hovers, 2 √(m g / 4 / (C_T ρ)) / D²: within its
// width, ζ f = 1.1 Hz.
TEST(ShippedPresets, ResonantIsAtResonance) {
  const Scenario scenario = Preset("resonant");
  const BarModes modes = ModesOf(scenario.flex, scenario.rig.calibrated.baseline_m);
  const double blade_pass_hz = 2 * std::sqrt(3.8 * 9.80665 / 4 / (0.105 * 1.225)) / (0.388 * 0.388);
  EXPECT_NEAR(modes.forward.frequency_radps / (2 * EIGEN_PI), blade_pass_hz, 0.3);
  EXPECT_EQ(scenario.vibration.source, VibrationSource::kRotors);
}

// Table 2.2 of the physical models: 7.7 px of disparity a kelvin; the baseline grows by 9.6 um.
TEST(ShippedPresets, ThermalYawsByFifteenPixels) {
  const Scenario scenario = Preset("thermal");
  const StereoRig rig = scenario.rig.calibrated.ToStereoRig();
  const RigMotion motion(rig, scenario.rig.misalignment, scenario.flex, scenario.vibration, 1, "x");
  const Eigen::Vector3d p_RQ_m(0, 0, 1e6);
  const auto seen = Project(motion.At(3), p_RQ_m).value();
  EXPECT_NEAR(seen.left_px.x() - seen.right_px.x(), 2 * 7.7, 0.1);
}

struct Pose {
  double t_s, x_m, y_m, z_m, qx, qy, qz, qw;
};

std::vector<Pose> ReadTum(const fs::path& file) {
  std::vector<Pose> poses;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream text(line);
    Pose p{};
    if (text >> p.t_s >> p.x_m >> p.y_m >> p.z_m >> p.qx >> p.qy >> p.qz >> p.qw) {
      poses.push_back(p);
    }
  }
  return poses;
}

// Of the rig of uavde_12mm.yaml, with 50 px (4 % of the width) to spare for vibration.
TEST(OutAndBack, StaysWhollyInViewOfBothCameras) {
  const auto poses = ReadTum(kScenarios / "trajectories/out_and_back.tum.txt");
  ASSERT_EQ(poses.size(), 421U);
  constexpr double kFocal_px = 3215, kHalfBaseline_m = 0.203, kHalfOffset_px = 36.4;
  // Propeller discs of an M200: motors 0.227 m from its axes, radius 0.216 m; 0.3 m covers its
  // height when tilted.
  constexpr double kMotor_m = 0.227, kRadius_m = 0.216, kHalfHeight_m = 0.3;
  for (const Pose& p : poses) {
    for (double angle = 0; angle < 6.28; angle += 0.1) {
      const double depth_m = p.x_m - kMotor_m - kRadius_m * std::cos(angle);
      const double side_m = std::abs(p.y_m) + kMotor_m + kRadius_m * std::sin(angle);
      const double u_px = kFocal_px * (side_m + kHalfBaseline_m) / depth_m + kHalfOffset_px;
      ASSERT_LT(u_px, 640 - 50) << p.t_s;
    }
    ASSERT_LT(kFocal_px * (std::abs(p.z_m) + kHalfHeight_m) / (p.x_m - 0.44), 360 - 20) << p.t_s;
  }
}

TEST(OutAndBack, FliesAsAMultirotorCan) {
  const auto poses = ReadTum(kScenarios / "trajectories/out_and_back.tum.txt");
  double nearest_m = 1e9, farthest_m = 0;
  for (std::size_t i = 1; i + 1 < poses.size(); ++i) {
    const Pose &a = poses[i - 1], &b = poses[i], &c = poses[i + 1];
    const double h_s = b.t_s - a.t_s;
    ASSERT_NEAR(h_s, 0.05, 1e-9);
    const double ax = (a.x_m - 2 * b.x_m + c.x_m) / (h_s * h_s);
    const double ay = (a.y_m - 2 * b.y_m + c.y_m) / (h_s * h_s);
    const double az = (a.z_m - 2 * b.z_m + c.z_m) / (h_s * h_s);
    EXPECT_LT(std::hypot(ax, ay, az), 4) << b.t_s;
    EXPECT_NEAR(b.qx * b.qx + b.qy * b.qy + b.qz * b.qz + b.qw * b.qw, 1, 1e-5);
    // B's z axis, from the quaternion, points along the thrust a + g.
    const double zx = 2 * (b.qx * b.qz + b.qy * b.qw), zy = 2 * (b.qy * b.qz - b.qx * b.qw);
    const double zz = 1 - 2 * (b.qx * b.qx + b.qy * b.qy);
    const double thrust = std::hypot(ax, ay, az + 9.81);
    // 0.02: six decimals of position over h² are 1e-6 / 0.05² = 4e-4 of 9.81; the rest is the
    // second difference itself.
    EXPECT_NEAR(zx, ax / thrust, 0.02) << b.t_s;
    EXPECT_NEAR(zy, ay / thrust, 0.02) << b.t_s;
    EXPECT_NEAR(zz, (az + 9.81) / thrust, 0.02) << b.t_s;
    nearest_m = std::min(nearest_m, b.x_m);
    farthest_m = std::max(farthest_m, b.x_m);
  }
  EXPECT_NEAR(nearest_m, 4.2, 0.01);
  EXPECT_NEAR(farthest_m, 40, 0.01);
}

}  // namespace
}  // namespace windhover
