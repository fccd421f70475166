// What holds for every camera model. A new model is one more type in `Models`.

#include "camera/camera_model.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/camera/camera_examples.h"
#include "tests/support/numeric_derivative.h"

namespace windhover {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Points in front of the camera, out to 39 degrees off axis, from 0.5 m to 100 m.
std::vector<Vector3d> ExamplePoints() {
  std::vector<Vector3d> points;
  for (const double depth_m : {0.5, 5.0, 100.0}) {
    for (double x = -0.65; x <= 0.65; x += 0.1) {
      for (double y = -0.5; y <= 0.5; y += 0.1) points.push_back(depth_m * Vector3d(x, y, 1));
    }
  }
  return points;
}

template <typename Model>
class CameraModelTest : public testing::Test {
 protected:
  const std::vector<Model> cameras_ = test::ExampleCameras<Model>();
};

using Models = testing::Types<PinholeRadtan, PinholeRational, KannalaBrandt, AnyCamera>;
TYPED_TEST_SUITE(CameraModelTest, Models);

// V3.2
TYPED_TEST(CameraModelTest, JacobianMatchesNumericDerivative) {
  for (const TypeParam& camera : this->cameras_) {
    for (const Vector3d& p_CQ_m : ExamplePoints()) {
      PixelFromPointJacobian analytic;
      ASSERT_TRUE(camera.Project(p_CQ_m, &analytic));
      const auto numeric = test::NumericDerivative<2, 3>(
          [&](const Vector3d& p) { return camera.Project(p).value(); }, p_CQ_m);
      // Central differences with a step of 1e-6 m leave about 1e-9 of a pixel per step.
      EXPECT_LT(test::RelativeError(analytic, numeric), 1e-6) << "at " << p_CQ_m.transpose();
    }
  }
}

// A pixel depends only on direction, so moving along the ray must not move the pixel.
TYPED_TEST(CameraModelTest, PixelIgnoresDistanceAlongRay) {
  for (const TypeParam& camera : this->cameras_) {
    for (const Vector3d& p_CQ_m : ExamplePoints()) {
      PixelFromPointJacobian dq_dp;
      ASSERT_TRUE(camera.Project(p_CQ_m, &dq_dp));
      EXPECT_LT((dq_dp * p_CQ_m).norm(), 1e-9 * dq_dp.norm() * p_CQ_m.norm());
    }
  }
}

TYPED_TEST(CameraModelTest, UnprojectUndoesProject) {
  for (const TypeParam& camera : this->cameras_) {
    for (const Vector3d& p_CQ_m : ExamplePoints()) {
      const Vector2d q_px = camera.Project(p_CQ_m).value();
      const std::optional<Vector3d> ray_C = camera.Unproject(q_px);
      ASSERT_TRUE(ray_C) << "at " << q_px.transpose();
      EXPECT_LT((*ray_C - p_CQ_m.normalized()).norm(), 1e-9) << "at " << q_px.transpose();
    }
  }
}

// V3.1: the other way round, to the promised 1e-9 px. Pixels cover each camera's image.
TYPED_TEST(CameraModelTest, ProjectUndoesUnproject) {
  for (const TypeParam& camera : this->cameras_) {
    const Vector2d centre_px = AnyCamera(camera).Project(Vector3d::UnitZ()).value();
    for (double u_px = 0; u_px < 2 * centre_px.x(); u_px += 31) {
      for (double v_px = 0; v_px < 2 * centre_px.y(); v_px += 29) {
        const std::optional<Vector3d> ray_C = camera.Unproject({u_px, v_px});
        ASSERT_TRUE(ray_C) << "at " << u_px << ", " << v_px;
        EXPECT_LT((camera.Project(*ray_C).value() - Vector2d(u_px, v_px)).norm(), 1e-9)
            << "at " << u_px << ", " << v_px;
      }
    }
  }
}

TYPED_TEST(CameraModelTest, HasNoAnswerForNotANumber) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const TypeParam& camera : this->cameras_) {
    EXPECT_FALSE(camera.Project(Vector3d(0, 0, kNan)));
    EXPECT_FALSE(camera.Unproject(Vector2d(kNan, 0)));
  }
}

TYPED_TEST(CameraModelTest, SeesNothingBehindTheLens) {
  for (const TypeParam& camera : this->cameras_) {
    EXPECT_FALSE(camera.Project(Vector3d(0.1, 0.1, -5)));
    EXPECT_FALSE(camera.Project(Vector3d(0.1, 0.1, 0)));
  }
}

// The check above must be able to fail: a derivative wrong by one part in 10^4 is caught.
TEST(NumericDerivativeTest, CatchesAWrongJacobian) {
  const PinholeRadtan camera = test::ExampleCameras<PinholeRadtan>().back();
  const Vector3d p_CQ_m(0.3, -0.2, 2);
  PixelFromPointJacobian analytic;
  ASSERT_TRUE(camera.Project(p_CQ_m, &analytic));
  analytic(0, 2) *= 1 + 1e-4;
  const auto numeric = test::NumericDerivative<2, 3>(
      [&](const Vector3d& p) { return camera.Project(p).value(); }, p_CQ_m);
  EXPECT_GT(test::RelativeError(analytic, numeric), 1e-6);
}

}  // namespace
}  // namespace windhover
