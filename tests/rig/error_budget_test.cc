// Every row of an error budget that was computed by exact projection in other code: what a
// disturbance of the true rig does to the depth that its calibration triangulates.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "camera/stereo_rig.h"
#include "common/geometry/rotation.h"
#include "rig/misalignment.h"

namespace windhover {
namespace {

const std::filesystem::path kGolden =
    std::filesystem::path(WINDHOVER_REAL_INPUTS_DIR) / "../golden/golden_error_budget.csv";

struct Row {
  double depth_m, x, y;
  std::string disturbance;
  double delta, exact_m;
};

bool ReadRow(std::istream& in, Row* row) {
  std::string line, closed_form;
  if (!std::getline(in, line)) return false;
  for (char& c : line) c = c == ',' ? ' ' : c;
  std::istringstream words(line);
  words >> row->depth_m >> row->x >> row->y >> row->disturbance >> row->delta >> closed_form >>
      row->exact_m;
  return !words.fail();
}

struct Rigs {
  PosedStereoRig truth;
  StereoRig assumed;
};

// Angles go through Misalignment, so that its signs are held against the table.
bool DisturbByMisalignment(const Row& row, const StereoRig& rig, Rigs* rigs) {
  const double deg = DegFromRad(row.delta);
  Misalignment m;
  if (row.disturbance == "yawR")
    m.right.yaw_deg = deg;
  else if (row.disturbance == "pitchR")
    m.right.pitch_deg = deg;
  else if (row.disturbance == "rollR")
    m.right.roll_deg = deg;
  else if (row.disturbance == "yawL")
    m.left.yaw_deg = deg;
  else if (row.disturbance == "pitchL")
    m.left.pitch_deg = deg;
  else if (row.disturbance == "rollL")
    m.left.roll_deg = deg;
  else if (row.disturbance == "cxL")
    m.left.cx_px = row.delta;
  else if (row.disturbance == "cxR")
    m.right.cx_px = row.delta;
  else
    return false;
  rigs->truth = Misaligned(rig, m);
  return true;
}

bool DisturbByCamera(const Row& row, Rigs* rigs) {
  PosedCamera& right = rigs->truth.right;
  auto& left_lens = rigs->truth.left.camera.As<PinholeRadtan>();
  auto& right_lens = right.camera.As<PinholeRadtan>();
  if (row.disturbance == "tx")
    right.X_RC.translation().x() += row.delta;
  else if (row.disturbance == "ty")
    right.X_RC.translation().y() += row.delta;
  else if (row.disturbance == "tz")
    right.X_RC.translation().z() += row.delta;
  else if (row.disturbance == "fR")
    right_lens.fx_px += row.delta;
  else if (row.disturbance == "fL")
    left_lens.fx_px += row.delta;
  else if (row.disturbance == "k1both")
    left_lens.k1 = right_lens.k1 = row.delta;
  else if (row.disturbance == "k1R")
    right_lens.k1 = row.delta;
  else if (row.disturbance == "p2R")
    right_lens.p2 = row.delta;
  else if (row.disturbance == "p1R")
    right_lens.p1 = row.delta;
  else if (row.disturbance == "fa")
    rigs->assumed.left.As<PinholeRadtan>().fx_px = rigs->assumed.right.As<PinholeRadtan>().fx_px +=
        row.delta;
  else if (row.disturbance == "Ba")
    rigs->assumed.baseline_m += row.delta;
  else
    return false;
  return true;
}

TEST(ErrorBudget, EveryRowAgreesWithTheGoldenTable) {
  std::ifstream in(kGolden);
  if (!in) GTEST_SKIP() << "no golden table at " << kGolden;
  const PinholeRadtan camera{.fx_px = 3215, .fy_px = 3215, .cx_px = 639.5, .cy_px = 359.5};
  const StereoRig rig{
      .left = camera, .right = camera, .baseline_m = 0.406, .width_px = 1280, .height_px = 720};
  std::string header;
  std::getline(in, header);
  int n = 0;
  for (Row row; ReadRow(in, &row); ++n) {
    Rigs rigs{Posed(rig), rig};
    ASSERT_TRUE(DisturbByMisalignment(row, rig, &rigs) || DisturbByCamera(row, &rigs))
        << row.disturbance;
    // The table's (x, y) are the left camera's.
    const Eigen::Vector3d p_RQ_m =
        row.depth_m * Eigen::Vector3d(row.x, row.y, 1) - Eigen::Vector3d(rig.baseline_m / 2, 0, 0);
    const auto seen = Project(rigs.truth, p_RQ_m);
    ASSERT_TRUE(seen);
    const auto point = Triangulate(rigs.assumed, seen->left_px, seen->right_px, 0);
    ASSERT_TRUE(point);
    // The table has nine digits; 1e-12 px of disparity are 1e-12 m at 40 m.
    EXPECT_NEAR(point->depth_m - row.depth_m, row.exact_m, 1e-8 * std::abs(row.exact_m) + 1e-11)
        << row.disturbance << " at " << row.depth_m << " m, " << row.x << ", " << row.y;
  }
  EXPECT_EQ(n, 304);
}

}  // namespace
}  // namespace windhover
