#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "render/benchmark_poses.h"

namespace windhover {

// The lens and rig of BenchmarkScenario().
inline constexpr int kPeerWidth_px = 1280, kPeerHeight_px = 720;
inline constexpr double kPeerFocal_px = 12e3 / 3.7325, kPeerK1 = -0.1, kPeerBaseline_m = 0.406;
/// Peers draw without distortion, this much wider, so that the bent image finds all its pixels.
inline constexpr double kPeerMargin = 1.02;

struct PeerMesh {
  std::vector<std::array<float, 3>> positions, normals;
  std::vector<std::array<unsigned char, 3>> colours;  ///< Red, green, blue.
  std::vector<std::array<unsigned, 3>> triangles;
};

/// Written by and for the peers: aircraft.ply. @throws std::runtime_error if it cannot be.
void WritePeerMesh(const PeerMesh& mesh, const std::filesystem::path& file);
PeerMesh ReadPeerMesh(const std::filesystem::path& file);

/// A sphere seen from inside, with places in an equirectangular image: (0, 0) is its top left.
struct PeerSphere {
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<float, 2>> places;
  std::vector<std::array<unsigned, 3>> triangles;
};
PeerSphere MakePeerSphere(float radius_m);

/// For each pixel of the distorted image, where it is in the undistorted one, pixels: CV_32FC2.
cv::Mat PeerDistortionMap();

/// The eye's centre in W; it looks east. 0 is left.
std::array<double, 3> PeerEye_m(int eye);

/// Sun and light from everywhere that peers use, as shares of a material's colour.
inline constexpr std::array<double, 3> kPeerSunFrom = {-0.32, 0.55, 0.77};
inline constexpr float kPeerSun = 0.7f, kPeerAmbient = 0.4f;

/// A peer's main(): parses `DIR --rounds N --images DIR`; `make(DIR)` returns what draws eye 0 or 1
/// of a pose into host memory, 8 bits RGB or BGR (`is_bgr`). Prints CPU and wall ms a stereo pair.
using DrawPeer = std::function<cv::Mat(int pose, int eye)>;
int RunPeer(const std::string& name, int argc, char** argv, bool is_bgr,
            const std::function<DrawPeer(const std::filesystem::path&)>& make);

}  // namespace windhover
