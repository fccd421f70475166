// Camera models against an independent implementation: the values are right, where
// camera_model_test.cc only shows that they are consistent with each other.

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "tests/camera/camera_examples.h"

namespace windhover {
namespace {

template <typename Model>
cv::Matx33d CameraMatrix(const Model& camera) {
  return {camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1};
}

std::vector<double> Distortion(const PinholeRadtan& camera) {
  return {camera.k1, camera.k2, camera.p1, camera.p2, camera.k3};
}

std::vector<double> Distortion(const PinholeRational& camera) {
  const PinholeRational::Terms& m = camera.DistortionTerms();
  return {m.k1, m.k2, m.p1, m.p2, m.k3, m.k4, m.k5, m.k6, m.s1, m.s2, m.s3, m.s4};
}

std::vector<double> Distortion(const KannalaBrandt& camera) {
  const KannalaBrandt::Terms& m = camera.DistortionTerms();
  return {m.k1, m.k2, m.k3, m.k4};
}

std::vector<cv::Point2d> ProjectByOpenCv(const auto& camera,
                                         const std::vector<cv::Point3d>& points) {
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), CameraMatrix(camera), Distortion(camera),
                    pixels);
  return pixels;
}

std::vector<cv::Point2d> ProjectByOpenCv(const KannalaBrandt& camera,
                                         const std::vector<cv::Point3d>& points) {
  std::vector<cv::Point2d> pixels;
  cv::fisheye::projectPoints(points, pixels, cv::Affine3d(), CameraMatrix(camera),
                             Distortion(camera));
  return pixels;
}

// Image-plane points, iterated to a fixed point: 1e-12 of a pixel stops on rounding.
std::vector<cv::Point2d> UnprojectByOpenCv(const auto& camera,
                                           const std::vector<cv::Point2d>& pixels) {
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 500, 1e-12);
  std::vector<cv::Point2d> points;
  cv::undistortPoints(pixels, points, CameraMatrix(camera), Distortion(camera), cv::noArray(),
                      cv::noArray(), until);
  return points;
}

std::vector<cv::Point2d> UnprojectByOpenCv(const KannalaBrandt& camera,
                                           const std::vector<cv::Point2d>& pixels) {
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 500, 1e-12);
  std::vector<cv::Point2d> points;
  cv::fisheye::undistortPoints(pixels, points, CameraMatrix(camera), Distortion(camera),
                               cv::noArray(), cv::noArray(), until);
  return points;
}

template <typename Model>
class CameraOpenCvTest : public testing::Test {};
using Models = testing::Types<PinholeRadtan, PinholeRational, KannalaBrandt>;
TYPED_TEST_SUITE(CameraOpenCvTest, Models);

TYPED_TEST(CameraOpenCvTest, ProjectAgrees) {
  for (const TypeParam& camera : test::ExampleCameras<TypeParam>()) {
    std::vector<cv::Point3d> points;
    for (double x = -0.6; x <= 0.6; x += 0.1) {
      for (double y = -0.5; y <= 0.5; y += 0.1) points.emplace_back(7 * x, 7 * y, 7);
    }
    const std::vector<cv::Point2d> expected = ProjectByOpenCv(camera, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto q_px = camera.Project({points[i].x, points[i].y, points[i].z});
      ASSERT_TRUE(q_px);
      EXPECT_NEAR(q_px->x(), expected[i].x, 1e-9);
      EXPECT_NEAR(q_px->y(), expected[i].y, 1e-9);
    }
  }
}

TYPED_TEST(CameraOpenCvTest, UnprojectAgrees) {
  for (const TypeParam& camera : test::ExampleCameras<TypeParam>()) {
    std::vector<cv::Point2d> pixels;
    for (double u_px = 0; u_px < 2 * camera.cx_px; u_px += 53) {
      for (double v_px = 0; v_px < 2 * camera.cy_px; v_px += 47) pixels.emplace_back(u_px, v_px);
    }
    const std::vector<cv::Point2d> expected = UnprojectByOpenCv(camera, pixels);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const auto ray_C = camera.Unproject({pixels[i].x, pixels[i].y});
      ASSERT_TRUE(ray_C);
      EXPECT_NEAR(ray_C->x() / ray_C->z(), expected[i].x, 1e-9);
      EXPECT_NEAR(ray_C->y() / ray_C->z(), expected[i].y, 1e-9);
    }
  }
}

// The map by which OpenCV undistorts an image says which pixel of it each ideal pixel shows. Its
// entries are floats, good to 6e-5 px below 1024 px.
TYPED_TEST(CameraOpenCvTest, UndistortionMapAgrees) {
  for (const TypeParam& camera : test::ExampleCameras<TypeParam>()) {
    const cv::Size size(320, 240);
    const cv::Matx33d ideal(300, 0, 159.5, 0, 300, 119.5, 0, 0, 1);
    cv::Mat u, v;
    if constexpr (std::is_same_v<TypeParam, KannalaBrandt>) {
      cv::fisheye::initUndistortRectifyMap(CameraMatrix(camera), Distortion(camera),
                                           cv::Matx33d::eye(), ideal, size, CV_32FC1, u, v);
    } else {
      cv::initUndistortRectifyMap(CameraMatrix(camera), Distortion(camera), cv::noArray(), ideal,
                                  size, CV_32FC1, u, v);
    }
    for (int y = 0; y < size.height; y += 17) {
      for (int x = 0; x < size.width; x += 19) {
        const auto q_px = camera.Project({(x - 159.5) / 300, (y - 119.5) / 300, 1});
        ASSERT_TRUE(q_px);
        EXPECT_NEAR(q_px->x(), u.at<float>(y, x), 2e-4);
        EXPECT_NEAR(q_px->y(), v.at<float>(y, x), 2e-4);
      }
    }
  }
}

}  // namespace
}  // namespace windhover
