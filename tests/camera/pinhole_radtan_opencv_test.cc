// PinholeRadtan against an independent implementation: the values are right, where
// camera_model_test.cc only shows that they are consistent with each other.

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "camera/pinhole_radtan.h"
#include "tests/camera/camera_examples.h"

namespace windhover {
namespace {

cv::Matx33d Intrinsics(const PinholeRadtan& camera) {
  return {camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1};
}

cv::Vec<double, 5> Distortion(const PinholeRadtan& camera) {
  return {camera.k1, camera.k2, camera.p1, camera.p2, camera.k3};
}

TEST(PinholeRadtan, ProjectAgreesWithOpenCv) {
  for (const PinholeRadtan& camera : test::ExampleCameras<PinholeRadtan>()) {
    std::vector<cv::Point3d> points;
    for (double x = -0.6; x <= 0.6; x += 0.1) {
      for (double y = -0.5; y <= 0.5; y += 0.1) points.emplace_back(7 * x, 7 * y, 7);
    }
    std::vector<cv::Point2d> expected;
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), Intrinsics(camera), Distortion(camera),
                      expected);
    for (size_t i = 0; i < points.size(); ++i) {
      const auto q_px = camera.Project({points[i].x, points[i].y, points[i].z});
      ASSERT_TRUE(q_px);
      EXPECT_NEAR(q_px->x(), expected[i].x, 1e-9);
      EXPECT_NEAR(q_px->y(), expected[i].y, 1e-9);
    }
  }
}

TEST(PinholeRadtan, UnprojectAgreesWithOpenCv) {
  // OpenCV iterates to a fixed point; told to reach 1e-12 of a pixel it stops on rounding.
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 500, 1e-12);
  for (const PinholeRadtan& camera : test::ExampleCameras<PinholeRadtan>()) {
    std::vector<cv::Point2d> pixels, expected;
    for (double u_px = 0; u_px < 2 * camera.cx_px; u_px += 53) {
      for (double v_px = 0; v_px < 2 * camera.cy_px; v_px += 47) pixels.emplace_back(u_px, v_px);
    }
    cv::undistortPoints(pixels, expected, Intrinsics(camera), Distortion(camera), cv::noArray(),
                        cv::noArray(), until);
    for (size_t i = 0; i < pixels.size(); ++i) {
      const auto ray_C = camera.Unproject({pixels[i].x, pixels[i].y});
      ASSERT_TRUE(ray_C);
      EXPECT_NEAR(ray_C->x() / ray_C->z(), expected[i].x, 1e-9);
      EXPECT_NEAR(ray_C->y() / ray_C->z(), expected[i].y, 1e-9);
    }
  }
}

}  // namespace
}  // namespace windhover
