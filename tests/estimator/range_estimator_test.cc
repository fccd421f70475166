#include "estimator/range_estimator.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "common/random/random_stream.h"

namespace windhover {
namespace {

stereo_box_t StereoBox(const Eigen::Vector2d& left_px, const Eigen::Vector2d& right_px,
                       double width_px) {
  stereo_box_t box{};
  box.left.x_px = left_px.x();
  box.left.y_px = left_px.y();
  box.right.x_px = right_px.x();
  box.right.y_px = right_px.y();
  box.left.w_px = box.right.w_px = width_px;
  box.left.h_px = box.right.h_px = width_px / 2;
  box.score = 1;
  return box;
}

AircraftConfig Config() {
  AircraftConfig config;
  config.estimator.methods = {"baseline", "offset1", "size"};
  return config;
}

/// The boxes that a perfect detector finds of a target of the width that `size` assumes.
stereo_box_t IdealBox(const AircraftConfig& config, const Eigen::Vector3d& p_RT_m) {
  const StereoRig rig = config.rig.ToStereoRig();
  const auto pixels = Project(Posed(rig), p_RT_m);
  return StereoBox(pixels->left_px, pixels->right_px,
                   rig.left.fx_px() * config.estimator.target_width_m / p_RT_m.z());
}

TEST(RangeEstimator, TriangulationWorkedExample) {
  // f = 12 mm / 3.75 µm = 3200 px, baseline 0.4 m: 128 px of disparity are at 10 m, and a px more
  // or less is 10² / (3200 · 0.4) = 0.078125 m.
  AircraftConfig config = Config();
  config.rig.focal_mm = 12;
  config.rig.pixel_um = 3.75;
  config.rig.baseline_m = 0.4;
  config.rig.image = {1281, 721};  // The principal point is pixel (640, 360).
  const auto box = StereoBox({640 + 64, 360}, {640 - 64, 360}, 100);
  const auto solution = MakeRangeEstimator("baseline", config)->Estimate({box});
  ASSERT_TRUE(solution);
  EXPECT_NEAR(solution->range_m, 10, 1e-12);
  EXPECT_NEAR(solution->range_sigma_m, 0.078125, 1e-12);
  EXPECT_NEAR((solution->p_RT_m - Eigen::Vector3d(0, 0, 10)).norm(), 0, 1e-12);
  EXPECT_EQ(solution->n_stages, 0);
}

TEST(RangeEstimator, OffsetWorkedExample) {
  AircraftConfig config = Config();
  config.rig.pixel_um = 3.75;
  config.rig.baseline_m = 0.4;
  config.rig.image = {1281, 721};
  config.estimator.offset1_px = 66;
  const auto box = StereoBox({640 + 64 + 33, 360}, {640 - 64 - 33, 360}, 100);
  const auto offset1 = MakeRangeEstimator("offset1", config)->Estimate({box});
  const auto baseline = MakeRangeEstimator("baseline", config)->Estimate({box});
  EXPECT_NEAR(offset1->range_m, 10, 1e-12);
  EXPECT_EQ(offset1->n_stages, 1);
  EXPECT_NEAR(baseline->range_m, 1280 / (128.0 + 66), 1e-12);
}

TEST(RangeEstimator, SizeWorkedExample) {
  // 3200 px · 0.8 m / 256 px = 10 m, with 10 % of uncertainty.
  AircraftConfig config = Config();
  config.rig.pixel_um = 3.75;
  config.rig.baseline_m = 0.4;
  config.rig.image = {1281, 721};
  config.estimator.target_width_m = 0.8;
  config.estimator.size_sigma = 0.1;
  auto box = StereoBox({640 + 64, 360}, {640 - 64, 360}, 256);
  box.left.w_px += 6;  // It is the mean width that counts.
  box.right.w_px -= 6;
  const auto solution = MakeRangeEstimator("size", config)->Estimate({box});
  EXPECT_NEAR(solution->range_m, 10, 1e-12);
  EXPECT_NEAR(solution->range_sigma_m, 1, 1e-12);
}

TEST(RangeEstimator, EveryMethodIsRightOnIdealBoxes) {
  AircraftConfig config = Config();
  config.rig.distortion = {.k1 = -0.1, .k2 = 0.05, .p1 = 1e-3, .p2 = -5e-4, .k3 = 0};
  for (const std::string& method : config.estimator.methods) {
    const auto estimator = MakeRangeEstimator(method, config);
    for (const double depth_m : {4.0, 9.0, 20.0, 40.0, 150.0}) {
      for (const double x : {-0.12, 0.0, 0.08}) {
        for (const double y : {-0.1, 0.0, 0.06}) {
          const Eigen::Vector3d p_RT_m = depth_m * Eigen::Vector3d(x, y, 1);
          const auto solution = estimator->Estimate({IdealBox(config, p_RT_m)});
          ASSERT_TRUE(solution) << method << " " << p_RT_m.transpose();
          // 1e-9: pixels inverted to 1e-12 px, magnified by at most depth / (f · baseline).
          EXPECT_NEAR(solution->range_m / p_RT_m.norm(), 1, 1e-9) << method;
          EXPECT_NEAR((solution->p_RT_m - p_RT_m).norm() / p_RT_m.norm(), 0, 1e-9) << method;
        }
      }
    }
  }
}

TEST(RangeEstimator, SigmaIsTheScatterOfNoisyBoxes) {
  AircraftConfig config = Config();
  config.estimator.disparity_sigma_px = 0.5;
  const Eigen::Vector3d p_RT_m(0.5, -0.3, 15);
  const auto estimator = MakeRangeEstimator("baseline", config);
  const stereo_box_t ideal = IdealBox(config, p_RT_m);
  const double sigma_m = estimator->Estimate({ideal})->range_sigma_m;
  RandomStream random(3, "boxes");
  constexpr int kDraws = 20'000;
  double squares = 0;
  for (int i = 0; i < kDraws; ++i) {
    stereo_box_t noisy = ideal;
    noisy.left.x_px += 0.5 * std::sqrt(0.5) * random.Normal();  // 0.5 px in the difference
    noisy.right.x_px += 0.5 * std::sqrt(0.5) * random.Normal();
    squares += std::pow((estimator->Estimate({noisy})->range_m - p_RT_m.norm()) / sigma_m, 2);
  }
  // A variance of 20,000 draws scatters by sqrt(2 / 20000) = 1 %; 4 % is four of those.
  EXPECT_NEAR(squares / kDraws, 1, 0.04);
}

TEST(RangeEstimator, WithholdsWhatIsNoDistance) {
  const AircraftConfig config = Config();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  std::vector<stereo_box_t> boxes;
  for (const double bad : {nan, inf, -inf}) {
    for (double image_box_t::*member :
         {&image_box_t::x_px, &image_box_t::y_px, &image_box_t::w_px, &image_box_t::h_px}) {
      boxes.push_back(StereoBox({700, 360}, {600, 360}, 50));
      boxes.back().left.*member = bad;
      boxes.push_back(StereoBox({700, 360}, {600, 360}, 50));
      boxes.back().right.*member = bad;
    }
  }
  boxes.push_back(stereo_box_t{});
  boxes.push_back(StereoBox({700, 360}, {600, 360}, 0));
  boxes.push_back(StereoBox({700, 360}, {600, 360}, -5));
  for (const std::string& method : config.estimator.methods) {
    const auto estimator = MakeRangeEstimator(method, config);
    EXPECT_TRUE(estimator->Estimate({StereoBox({700, 360}, {600, 360}, 50)})) << method;
    for (const stereo_box_t& box : boxes) EXPECT_FALSE(estimator->Estimate({box})) << method;
  }
}

TEST(RangeEstimator, TriangulationNeedsPositiveDisparity) {
  AircraftConfig config = Config();
  config.estimator.offset1_px = 20;
  EXPECT_FALSE(
      MakeRangeEstimator("baseline", config)->Estimate({StereoBox({600, 0}, {600, 0}, 9)}));
  EXPECT_FALSE(
      MakeRangeEstimator("baseline", config)->Estimate({StereoBox({600, 0}, {650, 0}, 9)}));
  EXPECT_FALSE(MakeRangeEstimator("offset1", config)->Estimate({StereoBox({619, 0}, {600, 0}, 9)}));
  EXPECT_TRUE(MakeRangeEstimator("offset1", config)->Estimate({StereoBox({621, 0}, {600, 0}, 9)}));
}

TEST(MakeRangeEstimator, RefusesAnUnknownName) {
  EXPECT_THROW(MakeRangeEstimator("guess", Config()), std::invalid_argument);
}

}  // namespace
}  // namespace windhover
