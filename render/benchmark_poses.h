#pragma once

#include <array>
#include <cmath>

namespace windhover {

/// Where the target of renderer benchmarks is: in front of an observer at W's origin that looks
/// east. Peers of the renderer include this header too, so it needs nothing else.
struct BenchmarkPose {
  std::array<double, 3> p_WB_m;
  double yaw_rad;
};

inline constexpr int kBenchmarkPoses = 16;
inline constexpr double kNearestBenchmarkPose_m = 4.5, kFarthestBenchmarkPose_m = 82;

/// Pose `i` of 16, log-spaced from 4.5 to 82 m, spread over the image, turned by 0.8 rad each.
inline BenchmarkPose BenchmarkPoseAt(int i) {
  const double depth_m =
      kNearestBenchmarkPose_m *
      std::pow(kFarthestBenchmarkPose_m / kNearestBenchmarkPose_m, i / (kBenchmarkPoses - 1.0));
  return {{depth_m, 0.05 * depth_m * std::sin(1.3 * i), 0.03 * depth_m * std::cos(1.7 * i)},
          0.8 * i};
}

}  // namespace windhover
