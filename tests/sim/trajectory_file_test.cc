#include "sim/trajectory_file.h"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/fields.h"
#include "tests/support/scratch_file.h"

namespace windhover {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

std::string ErrorOf(const std::string& content) {
  const std::string file = test::ScratchFile(content);
  try {
    ReadTrajectoryFile(file);
  } catch (const ConfigError& e) {
    return std::string(e.what()).substr(file.size());
  }
  return "";
}

TEST(ReadTrajectoryFile, ReadsTum) {
  const auto poses = ReadTrajectoryFile(
      test::ScratchFile("# timestamp(s) tx ty tz qx qy qz qw\n1403715273.5 1 2 3 0 0 0 1\n"
                        "1403715273.75 4 5 6 0 0 0.2 2\n"));
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0].t_s, 0);
  EXPECT_EQ(poses[1].t_s, 0.25);
  EXPECT_EQ(poses[1].p_m, Vector3d(4, 5, 6));
  EXPECT_TRUE(poses[1].q.isApprox(Quaterniond(2, 0, 0, 0.2).normalized()));
}

TEST(ReadTrajectoryFile, ReadsEuroc) {
  const auto poses = ReadTrajectoryFile(test::ScratchFile(
      "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],"
      "q_RS_z [],v_RS_R_x [m s^-1]\n"
      "1403715273262142976,1,2,3,1,0,0,0,9\n1403715273267143168,4,5,6,2,0,0,0.2,9\n"));
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_NEAR(poses[1].t_s, 0.005, 1e-6);  // A double holds these times to 256 ns.
  EXPECT_EQ(poses[1].p_m, Vector3d(4, 5, 6));
  EXPECT_TRUE(poses[1].q.isApprox(Quaterniond(2, 0, 0, 0.2).normalized()));
}

TEST(ReadTrajectoryFile, ReportsEveryBadLine) {
  EXPECT_EQ(ErrorOf("0 1 2 3 0 0 0 1\n1 1 2 3 0 0 0 1 5\n"), ":2: must have 8 columns (found 9)");
  EXPECT_THAT(ErrorOf("0 1 2 3 0 0 0 1\n"
                      "1 nan 2 3 0 0 0 1\n"
                      "2 1 2 3 0 0 0\n"
                      "3 1 2 3 0 0 0 0\n"
                      "4 1 2 3 0 0 0 1\n"
                      "4 1 2 3 0 0 0 1\n"
                      "x 1 2 3 0 0 0 1\n"),
              testing::AllOf(testing::HasSubstr(":2: column 2: must be a finite number"),
                             testing::HasSubstr(":3: must have 8 columns (found 7)"),
                             testing::HasSubstr(":4: must have a quaternion of length 1 (found 0)"),
                             testing::HasSubstr(":6: time must rise from line to line"),
                             testing::HasSubstr(":7: column 1: must be a finite number")));
  EXPECT_EQ(ErrorOf("0 1 2 3 0 0 0 1 7\n1 1 2 3 0 0 0 1 7\n"),
            ":1: must have 8 columns, t x y z qx qy qz qw (found 9)");
  EXPECT_THAT(ErrorOf("0 1 2 3 0 0 0 1\n"), testing::HasSubstr("at least 2 poses"));
  EXPECT_THAT(ErrorOf(""), testing::HasSubstr("(found 0)"));
}

// Four ways to mount a sensor on a body that flies level, heading 0.3 rad, and rocks a little.
struct Mounting {
  const char* name;
  Eigen::Matrix3d body_from_sensor;
};

TEST(ReadTrajectoryFile, FindsTheBodyWhateverTheSensorsAxes) {
  Eigen::Matrix3d flu = Eigen::Matrix3d::Identity(), frd, camera, euroc;
  frd << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // right, down, forward
  euroc << 0, 0, 1, 0, -1, 0, 1, 0, 0;    // up, right, forward
  for (const Mounting& mounting :
       {Mounting{"flu", flu}, {"frd", frd}, {"camera", camera}, {"euroc", euroc}}) {
    std::string text;
    std::vector<Quaterniond> bodies;
    for (int i = 0; i < 20; ++i) {
      const Quaterniond body(Eigen::AngleAxisd(0.3, Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(0.2 * std::sin(i), Vector3d::UnitX()));
      bodies.push_back(body);
      const Quaterniond q = body * Quaterniond(mounting.body_from_sensor);
      text += std::to_string(i) + " 0 0 0 " + std::to_string(q.x()) + " " + std::to_string(q.y()) +
              " " + std::to_string(q.z()) + " " + std::to_string(q.w()) + "\n";
    }
    const auto poses = ReadTrajectoryFile(test::ScratchFile(text, mounting.name));
    for (int i = 0; i < 20; ++i) {
      // Six digits of a quaternion.
      EXPECT_LT(poses[i].q.angularDistance(bodies[i]), 1e-5) << mounting.name;
    }
  }
}

TEST(ReadTrajectoryFile, ReadsRecordedFlights) {
  const std::filesystem::path folder = WINDHOVER_REAL_INPUTS_DIR "/trajectories";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no recordings at " << folder;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto poses = ReadTrajectoryFile(entry.path());
    EXPECT_TRUE(HasAttitude(poses));
    Vector3d up = Vector3d::Zero();
    for (const RecordedPose& pose : poses) up += pose.q * Vector3d::UnitZ();
    // A multirotor flies upright: within 25 degrees on average, its IMU's tilt included.
    EXPECT_GT(up.normalized().z(), 0.9) << entry.path();
  }
}

}  // namespace
}  // namespace windhover
