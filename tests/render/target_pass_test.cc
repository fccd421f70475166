#include "render/target_pass.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "common/geometry/rotation.h"
#include "render/aircraft_meshes.h"
#include "render/annotator.h"
#include "render/layer_sum.h"
#include "render/mesh_builder.h"
#include "render/motion.h"

namespace windhover {
namespace {

constexpr int kWidth_px = 1280, kHeight_px = 720;
constexpr double kMaxBlur_px = 0.5;

PinholeRadtan Camera(double k1 = 0, double k2 = 0) {
  return {.fx_px = 3215, .fy_px = 3215, .cx_px = 639.5, .cy_px = 359.5, .k1 = k1, .k2 = k2};
}

ShadedTarget White(const PreparedModel& model, double depth_m) {
  const DetailLevel& level = model.LevelFor(depth_m, 3215);
  return {&model, &level,
          std::vector<Eigen::Vector3f>(level.body.positions.size(), Eigen::Vector3f::Ones()),
          std::vector<Eigen::Vector3f>(level.discs.positions.size(), Eigen::Vector3f::Ones())};
}

Eigen::Isometry3d At(const Eigen::Vector3d& p_C, const Eigen::Matrix3d& R_CB) {
  Eigen::Isometry3d X_CB = Eigen::Isometry3d::Identity();
  X_CB.translation() = p_C;
  X_CB.linear() = R_CB;
  return X_CB;
}

// During an exposure of half a turn two blades pass every place once.
const RotorTurning kHalfTurn{.phase_rev = {}, .rate_hz = {50, 50, 50, 50}, .duration_s = 0.01};

struct Centroid {
  double x_px = 0, y_px = 0, area_px = 0;
};

Centroid CentroidOf(const TargetLayer& layer) {
  Centroid c;
  for (int y = 0; y < layer.roi.height; ++y) {
    for (int x = 0; x < layer.roi.width; ++x) {
      const double a = layer.pixels[static_cast<std::size_t>(y * layer.roi.width + x)][3] / 65535.0;
      c.area_px += a;
      c.x_px += a * (layer.roi.x0 + x);
      c.y_px += a * (layer.roi.y0 + y);
    }
  }
  c.x_px /= c.area_px;
  c.y_px /= c.area_px;
  return c;
}

class TargetPassTest : public testing::TestWithParam<Rasteriser> {};
INSTANTIATE_TEST_SUITE_P(Rasterisers, TargetPassTest,
                         testing::Values(Rasteriser::kOsMesa, Rasteriser::kNative));

// The outline of a sphere is a cone; in a pinhole image it is an ellipse. With the centre at
// (X, Y, Z) and t² = Z² - r²: centre f (X, Y) Z / t², area π f² r² Z |p|-ish; see below.
TEST_P(TargetPassTest, SphereIsWhereItsConeIs) {
  constexpr double kRadius_m = 0.3;
  AircraftModel ball;
  AddEllipsoid({0, 0, 0}, Eigen::Vector3f::Constant(kRadius_m), 128, {1, 1, 1}, &ball.body);
  const PreparedModel model(ball, kRadius_m);
  const auto pass = MakeTargetPass(GetParam(), kMaxBlur_px);
  double squares = 0, worst = 0;
  int n = 0;
  for (const double depth_m : {7.0, 12.0, 17.0, 25.0, 41.0, 80.0}) {
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d p_C(depth_m * 0.0211 * (i - 3), depth_m * 0.0127 * (3 - i) * (i % 3),
                                depth_m);
      const std::array poses = {At(p_C, RotationFromVector({0.3 * i, 0.1, 0.2}))};
      const TargetLayer layer =
          pass->Draw(White(model, depth_m), Camera(), kWidth_px, kHeight_px, poses, kHalfTurn);
      const Centroid drawn = CentroidOf(layer);
      // The cone d·p = |p| cos, projected: an ellipse about f (X, Y) Z / (Z² - r²).
      const double r2 = kRadius_m * kRadius_m, t2 = p_C.z() * p_C.z() - r2;
      const double x_px = 639.5 + 3215 * p_C.x() * p_C.z() / t2;
      const double y_px = 359.5 + 3215 * p_C.y() * p_C.z() / t2;
      const double rho2 = p_C.head<2>().squaredNorm();
      const double area = M_PI * 3215 * 3215 * r2 * std::sqrt(t2 * (t2 + rho2)) / (t2 * t2);
      EXPECT_NEAR(drawn.area_px / area, 1, 0.01) << depth_m;
      const double error = std::hypot(drawn.x_px - x_px, drawn.y_px - y_px);
      worst = std::max(worst, error);
      squares += error * error;
      ++n;
    }
  }
  // docs/sources.md (measured on a prototype): 2 × 2 samples 0.016 rms and 0.025 max.
  EXPECT_LT(std::sqrt(squares / n), 0.016);
  EXPECT_LT(worst, 0.03);
}

class Silhouette : public testing::TestWithParam<std::tuple<Rasteriser, double>> {};

// V3.5: the box of the drawn samples is that of the projected vertices, to the sample spacing:
// half a sample is lost where a corner passes between sample centres. Propellers, which fade out
// towards the rims of their discs, only stay within theirs.
TEST_P(Silhouette, IsWhereVerticesAreProjected) {
  const auto [rasteriser, depth_m] = GetParam();
  const AircraftModel whole = MakeM200(true);
  AircraftModel body = whole;
  body.rotor_discs = {};
  body.propellers.clear();
  const auto pass = MakeTargetPass(rasteriser, kMaxBlur_px);
  for (const AircraftModel* m200 : {&whole, &std::as_const(body)}) {
    std::vector<Eigen::Vector3f> points = m200->body.positions;
    const auto& rims = m200->rotor_discs.positions;
    points.insert(points.end(), rims.begin(), rims.end());
    std::vector<Eigen::Vector3d> outline;
    for (const auto i : ExtremeVertices(points)) outline.push_back(points[i].cast<double>());
    const PreparedModel model(*m200, 0.7);
    for (int i = 0; i < 6; ++i) {
      const Eigen::Matrix3d R_CB =
          R_BC_Forward().transpose() * RotationFromVector({0.1, 0.25, 0.7 * i});
      const Eigen::Isometry3d X_CB =
          At({depth_m * 0.02 * (i - 2), depth_m * 0.01 * i, depth_m}, R_CB);
      const PinholeRadtan camera = Camera(-0.25, 0.4);
      const std::array poses = {X_CB};
      const std::array layers = {
          pass->Draw(White(model, depth_m), camera, kWidth_px, kHeight_px, poses, kHalfTurn)};
      target_view_t view = ViewFromGeometry(outline, X_CB, camera, kWidth_px, kHeight_px);
      const image_box_t full = view.visible;
      SetVisibility(layers, 0, &view);
      const double half_sample_px = 0.5 / layers[0].samples_per_px;
      EXPECT_LE(view.visible.w_px, full.w_px + 4 * half_sample_px);
      EXPECT_LE(view.visible.h_px, full.h_px + 4 * half_sample_px);
      if (m200 == &whole) continue;
      EXPECT_NEAR(view.visible.x_px, full.x_px, 0.1 + half_sample_px);
      EXPECT_NEAR(view.visible.y_px, full.y_px, 0.1 + half_sample_px);
      EXPECT_NEAR(view.visible.w_px, full.w_px, 2 * (half_sample_px + 0.25));
      EXPECT_NEAR(view.visible.h_px, full.h_px, 2 * (half_sample_px + 0.25));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Distances, Silhouette,
                         testing::Combine(testing::Values(Rasteriser::kOsMesa, Rasteriser::kNative),
                                          testing::Values(5.0, 10.0, 20.0, 40.0)));

// V7.3: propeller tip to propeller tip, seen from ahead, spans f W / Z.
// Against sums sample by sample, for moves that leave and cross the region.
TEST(LayerSum, AddsEachSampleToThePixelItMovedTo) {
  constexpr int kSamples = 3;
  const PixelRect roi{10, 20, 7, 6}, shown{11, 19, 5, 4};
  std::vector<TargetCanvas::Pixel> samples(5 * 4 * kSamples * kSamples);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto value = static_cast<std::uint16_t>(65535 - 331 * i);
    samples[i] = {value, 1, static_cast<std::uint16_t>(i), 65535};
  }
  std::vector<SampleShift> shifts;
  for (int i = -3; i <= 3; ++i) shifts.push_back({5 * i, 2 * i + 1});
  shifts.push_back({100, -100});
  BoxSums boxes;
  boxes.Set(samples, shown, kSamples);
  LayerSum sum(roi, kSamples);
  sum.Add(boxes, shifts);
  std::vector<std::array<std::uint32_t, 4>> expected(7 * 6);
  for (const SampleShift& shift : shifts) {
    for (int y = 0; y < 4 * kSamples; ++y) {
      for (int x = 0; x < 5 * kSamples; ++x) {
        const int column = (shown.x0 - roi.x0) * kSamples + x + shift.columns;
        const int row = (shown.y0 - roi.y0) * kSamples + y + shift.rows;
        if (column < 0 || row < 0 || column >= 7 * kSamples || row >= 6 * kSamples) continue;
        auto& pixel = expected[static_cast<std::size_t>(row / kSamples * 7 + column / kSamples)];
        const auto& sample = samples[static_cast<std::size_t>(y * 5 * kSamples + x)];
        for (std::size_t c = 0; c < 4; ++c) pixel[c] += sample[c];
      }
    }
  }
  for (int i = 0; i < 7 * 6; ++i) {
    EXPECT_EQ(*sum.PixelsAt(roi.x0 + i % 7, roi.y0 + i / 7), expected[static_cast<std::size_t>(i)])
        << i;
  }
}

TEST_P(TargetPassTest, WidthIsFocalLengthTimesWidthOverDepth) {
  const PreparedModel model(MakeM200(true), 0.7);
  const auto pass = MakeTargetPass(GetParam(), kMaxBlur_px);
  const std::array poses = {At({0, 0, 20}, R_BC_Forward().transpose())};
  const std::array layers = {
      pass->Draw(White(model, 20), Camera(), kWidth_px, kHeight_px, poses, kHalfTurn)};
  target_view_t view{};
  SetVisibility(layers, 0, &view);
  EXPECT_NEAR(view.visible.w_px, 3215 * 0.880 / 20, 2.5);  // Discs are at ±0.23 m of depth: 1.6 px.
  EXPECT_NEAR(view.visible.h_px, 3215 * 0.378 / 20, 1);
}

// Lines that the lens bends are drawn straight between vertices. The bound of docs/sources.md,
// 0.014 px at 40 px, holds for the midpoint of every edge that LevelFor lets through.
TEST(PreparedModel, EdgesAreShortEnoughForTheLens) {
  const PreparedModel model(MakeM200(true), 0.7);
  const PinholeRadtan camera = Camera(-0.25, 0.4);
  for (const double depth_m : {4.0, 8.0, 20.0}) {
    const Mesh& mesh = model.LevelFor(depth_m, 3215).body;
    const Eigen::Isometry3d X_CB =
        At({depth_m * 0.12, depth_m * 0.05, depth_m}, R_BC_Forward().transpose());
    double worst = 0;
    for (const auto& t : mesh.triangles) {
      const Eigen::Vector3d a = X_CB * mesh.positions[t[0]].cast<double>();
      const Eigen::Vector3d b = X_CB * mesh.positions[t[1]].cast<double>();
      const auto qa = camera.Project(a), qb = camera.Project(b);
      if (!qa || !qb) continue;
      // Perspective alone keeps lines straight, so the distance to the chord counts.
      const auto qm = camera.Project((a + b) / 2);
      const Eigen::Vector2d along = (*qb - *qa).normalized(), off = *qm - *qa;
      worst = std::max(worst, std::abs(along.x() * off.y() - along.y() * off.x()));
    }
    EXPECT_LT(worst, 0.02) << depth_m;
  }
}

// Width between the first and the last column that anything of the target covers.
int CoveredWidthPx(const TargetLayer& layer) {
  int first = layer.roi.width, last = -1;
  for (int y = 0; y < layer.roi.height; ++y) {
    for (int x = 0; x < layer.roi.width; ++x) {
      if (layer.pixels[static_cast<std::size_t>(y * layer.roi.width + x)][3] == 0) continue;
      first = std::min(first, x);
      last = std::max(last, x);
    }
  }
  return last - first + 1;
}

// The poses of a target 20 m ahead during an exposure of an observer that yaws to the left.
std::vector<RowPoses> PosesWhileYawing(double rate_radps, const std::vector<double>& offsets_s) {
  const RigMotion rig({.left = Camera(),
                       .right = Camera(),
                       .baseline_m = 0.406,
                       .width_px = kWidth_px,
                       .height_px = kHeight_px},
                      {}, {}, {}, 1, "uav0");
  world_truth_t world{};
  world.uavs.resize(2);
  world.uavs[0].qw = world.uavs[1].qw = 1;
  world.uavs[0].w_WB_B_radps[2] = rate_radps;
  world.uavs[1].p_WB_m[0] = 20;
  const Eigen::Isometry3d X_BR = At(Eigen::Vector3d::Zero(), R_BC_Forward());
  std::vector<RowPoses> poses;
  for (const double offset_s : offsets_s) {
    const auto cameras = CamerasByRows(world, 0, X_BR, rig, {}, kHeight_px, offset_s);
    poses.push_back(PosesOf(cameras.left, world.uavs[1]));
  }
  return poses;
}

// V3.6: turning at ω for T smears the image by f ω T = 96.5 px: so much wider is the target, and
// its centroid half as far from where it is at the beginning, where it is in the middle. 65
// sub-exposures at the middles of equal parts leave out 1/65 = 1.5 % of the width, edges between
// pixels up to 2 px, 2 %: within the 5 % that is asked for. Samples (3 a pixel) that move as a
// whole round each shift by up to 1/6 px, evenly to both sides.
TEST_P(TargetPassTest, TurningSmearsByItsRate) {
  constexpr double kRate_radps = 1.5, kDuration_s = 0.02,
                   kSmear_px = 3215 * kRate_radps * kDuration_s;
  constexpr int kParts = 65;
  std::vector<double> offsets_s;
  for (int i = 0; i < kParts; ++i) {
    offsets_s.push_back(kDuration_s * ((i + 0.5) / kParts - 0.5));
  }
  RotorTurning turning = kHalfTurn;  // In each part, so that blades are everywhere alike.
  turning.duration_s *= kParts;
  const PreparedModel model(MakeM200(true), 0.7);
  const ShadedTarget target = White(model, 20);
  for (const double hidden_px : {kMaxBlur_px, 0.0}) {  // One drawing that moves; one for each part.
    const auto pass = MakeTargetPass(GetParam(), hidden_px);
    const auto draw = [&](const std::vector<double>& at_s) {
      const std::vector<RowPoses> poses = PosesWhileYawing(kRate_radps, at_s);
      return pass->Draw(target, Camera(), kWidth_px, kHeight_px, std::span<const RowPoses>(poses),
                        turning);
    };
    const TargetLayer blurred = draw(offsets_s), middle = draw({0}),
                      start = draw({-kDuration_s / 2});
    const Centroid a = CentroidOf(blurred), b = CentroidOf(middle), c = CentroidOf(start);
    EXPECT_NEAR(CoveredWidthPx(blurred) - CoveredWidthPx(middle), kSmear_px, 0.05 * kSmear_px);
    EXPECT_NEAR(a.x_px - c.x_px, kSmear_px / 2, 0.05);  // The image moves to the right.
    EXPECT_NEAR(a.x_px, b.x_px, 0.05);
    EXPECT_NEAR(a.y_px, b.y_px, 0.05);
    EXPECT_NEAR(a.area_px, b.area_px, 0.01 * b.area_px);
  }
}

// A target that closes in grows during the exposure: its rim moves by about ±0.3 px, evenly to both
// sides of the middle pose. Drawn once or for each sub-exposure, its image has the same centre and
// size; 0.02 px is what either drawing is true to (above) where no edge lies along the samples.
TEST_P(TargetPassTest, GrowthThatOneDrawingHidesMovesNothing) {
  const PreparedModel model(MakeM200(true), 0.7);
  const auto each = MakeTargetPass(GetParam(), 0), once = MakeTargetPass(GetParam(), 1);
  const Eigen::Matrix3d R_CB = R_BC_Forward().transpose() * RotationFromVector({0.1, 0.25, 0.7});
  std::vector<Eigen::Isometry3d> poses;
  for (int i = -2; i <= 2; ++i) poses.push_back(At({0.4, 0.2, 8 - 0.0024 * i}, R_CB));
  const ShadedTarget target = White(model, 8);
  const TargetLayer all = each->Draw(target, Camera(), kWidth_px, kHeight_px, poses, kHalfTurn);
  const TargetLayer one = once->Draw(target, Camera(), kWidth_px, kHeight_px, poses, kHalfTurn);
  const Centroid a = CentroidOf(all), b = CentroidOf(one);
  EXPECT_NEAR(a.x_px, b.x_px, 0.02);
  EXPECT_NEAR(a.y_px, b.y_px, 0.02);
  EXPECT_NEAR(b.area_px / a.area_px, 1, 2e-3);
}

TEST_P(TargetPassTest, LeavesOutWhatIsBehindOrBeside) {
  const PreparedModel model(MakeM200(true), 0.7);
  const auto pass = MakeTargetPass(GetParam(), kMaxBlur_px);
  for (const Eigen::Vector3d& p_C :
       {Eigen::Vector3d(0, 0, -10), Eigen::Vector3d(30, 0, 20), Eigen::Vector3d(0, -30, 20)}) {
    const std::array poses = {At(p_C, Eigen::Matrix3d::Identity())};
    EXPECT_TRUE(pass->Draw(White(model, 20), Camera(), kWidth_px, kHeight_px, poses, kHalfTurn)
                    .roi.IsEmpty());
  }
}

TEST_P(TargetPassTest, SurvivesATargetAroundTheCamera) {
  const PreparedModel model(MakeM200(true), 0.7);
  const auto pass = MakeTargetPass(GetParam(), kMaxBlur_px);
  for (const double depth_m : {0.0, 0.2, 0.5}) {
    const std::array poses = {At({0, 0, depth_m}, R_BC_Forward().transpose())};
    const TargetLayer layer = pass->Draw(White(model, depth_m), Camera(-0.25, 0.4), kWidth_px,
                                         kHeight_px, poses, kHalfTurn);
    EXPECT_LE(layer.roi.width, kWidth_px);
    EXPECT_LE(layer.roi.height, kHeight_px);
  }
}

}  // namespace
}  // namespace windhover
