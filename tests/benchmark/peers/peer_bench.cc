#include "tests/benchmark/peers/peer_bench.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <time.h>

namespace windhover {
namespace {

double Cpu_s() {
  timespec cpu{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu);
  return static_cast<double>(cpu.tv_sec) + 1e-9 * static_cast<double>(cpu.tv_nsec);
}

double Wall_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void Measure(const std::string& name, int rounds, const DrawPeer& draw) {
  double cpu_s = 1e9, wall_s = 1e9;
  for (int round = 0; round <= rounds; ++round) {
    const double cpu_start_s = Cpu_s(), wall_start_s = Wall_s();
    for (int i = 0; i < 2 * kBenchmarkPoses; ++i) draw(i / 2, i % 2);
    if (round == 0) continue;  // Warms up.
    cpu_s = std::min(cpu_s, Cpu_s() - cpu_start_s);
    wall_s = std::min(wall_s, Wall_s() - wall_start_s);
  }
  fmt::print("{} {:.2f} {:.2f}\n", name, 1e3 * cpu_s / kBenchmarkPoses,
             1e3 * wall_s / kBenchmarkPoses);
}

void WriteImages(const std::string& name, const std::string& folder, bool is_bgr,
                 const DrawPeer& draw) {
  std::filesystem::create_directories(folder);
  for (int pose = 0; pose < kBenchmarkPoses; pose += 5) {
    cv::Mat image = draw(pose, 0).clone();
    if (!is_bgr) {
      for (auto p = image.begin<cv::Vec3b>(); p != image.end<cv::Vec3b>(); ++p) {
        std::swap((*p)[0], (*p)[2]);
      }
    }
    cv::imwrite(fmt::format("{}/{}_{:02}.png", folder, name, pose), image);
  }
}

}  // namespace

void WritePeerMesh(const PeerMesh& mesh, const std::filesystem::path& file) {
  std::ofstream out(file);
  out << "ply\nformat ascii 1.0\nelement vertex " << mesh.positions.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
         "property float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\n"
         "property uchar blue\nelement face "
      << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    for (const float x : mesh.positions[i]) out << x << ' ';
    for (const float x : mesh.normals[i]) out << x << ' ';
    for (const int c : mesh.colours[i]) out << c << ' ';
    out << '\n';
  }
  for (const auto& t : mesh.triangles) out << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

PeerMesh ReadPeerMesh(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::size_t n_vertices = 0, n_triangles = 0;
  for (std::string line; std::getline(in, line) && line != "end_header";) {
    std::sscanf(line.c_str(), "element vertex %zu", &n_vertices);
    std::sscanf(line.c_str(), "element face %zu", &n_triangles);
  }
  PeerMesh mesh;
  mesh.positions.resize(n_vertices);
  mesh.normals.resize(n_vertices);
  mesh.colours.resize(n_vertices);
  mesh.triangles.resize(n_triangles);
  for (std::size_t i = 0; i < n_vertices; ++i) {
    for (float& x : mesh.positions[i]) in >> x;
    for (float& x : mesh.normals[i]) in >> x;
    for (unsigned char& c : mesh.colours[i]) {
      int value = 0;
      in >> value;
      c = static_cast<unsigned char>(value);
    }
  }
  for (auto& t : mesh.triangles) {
    int n = 0;
    in >> n >> t[0] >> t[1] >> t[2];
  }
  if (!in || n_triangles == 0) throw std::runtime_error(file.string() + ": not by peer_inputs");
  return mesh;
}

PeerSphere MakePeerSphere(float radius_m) {
  constexpr int kColumns = 128, kRows = 64;
  constexpr auto kPi = static_cast<float>(EIGEN_PI);
  PeerSphere sphere;
  for (int row = 0; row <= kRows; ++row) {
    for (int column = 0; column <= kColumns; ++column) {
      const float u = static_cast<float>(column) / kColumns, v = static_cast<float>(row) / kRows;
      const float azimuth = (0.5f - u) * 2 * kPi, elevation = (0.5f - v) * kPi;
      sphere.positions.push_back({radius_m * std::cos(elevation) * std::cos(azimuth),
                                  radius_m * std::cos(elevation) * std::sin(azimuth),
                                  radius_m * std::sin(elevation)});
      sphere.places.push_back({u, v});
    }
  }
  for (unsigned row = 0; row < kRows; ++row) {
    for (unsigned column = 0; column < kColumns; ++column) {
      const unsigned i = row * (kColumns + 1) + column, below = i + kColumns + 1;
      sphere.triangles.push_back({i, i + 1, below});
      sphere.triangles.push_back({i + 1, below + 1, below});
    }
  }
  return sphere;
}

cv::Mat PeerDistortionMap() {
  cv::Mat map(kPeerHeight_px, kPeerWidth_px, CV_32FC2);
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      map.at<cv::Vec2f>(y, x) = {static_cast<float>(x), static_cast<float>(y)};
    }
  }
  constexpr double kCx_px = (kPeerWidth_px - 1) / 2.0, kCy_px = (kPeerHeight_px - 1) / 2.0;
  const cv::Matx33d lens(kPeerFocal_px, 0, kCx_px, 0, kPeerFocal_px, kCy_px, 0, 0, 1);
  const double wide_px = kPeerFocal_px / kPeerMargin;
  const cv::Matx33d drawn(wide_px, 0, kCx_px, 0, wide_px, kCy_px, 0, 0, 1);
  cv::Mat points = map.reshape(2, map.rows * map.cols), undistorted;
  cv::undistortPoints(points, undistorted, lens, cv::Vec4d(kPeerK1, 0, 0, 0), cv::noArray(), drawn);
  return undistorted.reshape(2, kPeerHeight_px).clone();
}

std::array<double, 3> PeerEye_m(int eye) {
  return {0, eye == 0 ? kPeerBaseline_m / 2 : -kPeerBaseline_m / 2, 0};
}

int RunPeer(const std::string& name, int argc, char** argv, bool is_bgr,
            const std::function<DrawPeer(const std::filesystem::path&)>& make) {
  std::string inputs, images;
  int rounds = 5;
  CLI::App app("times stereo pairs of another renderer", name);
  app.add_option("INPUTS", inputs, "folder that peer_inputs has written")->required();
  app.add_option("--rounds", rounds, "of which the least counts")->check(CLI::Range(1, 1000));
  app.add_option("--images", images, "folder for what it draws");
  try {
    app.parse(argc, argv);
    const DrawPeer draw = make(inputs);
    if (!images.empty()) WriteImages(name, images, is_bgr, draw);
    Measure(name, rounds, draw);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: error: {}\n", name, error.what());
    return 3;
  }
}

}  // namespace windhover
