// Writes what the peers draw: aircraft.ply (the M200 without propellers), panorama.png (the
// surroundings) and ours_NN.png (what windhover makes of the same poses).

#include <cmath>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "common/image/srgb.h"
#include "common/process/process.h"
#include "render/aircraft_meshes.h"
#include "render/benchmark_scene.h"
#include "render/environment.h"
#include "render/stereo_renderer.h"
#include "tests/benchmark/peers/peer_bench.h"

namespace windhover {
namespace {

constexpr int kPanoramaWidth_px = 4096;

unsigned char ByteFrom(float linear) {
  return static_cast<unsigned char>(
      std::lround(255 * SrgbFromLinear(std::clamp(linear, 0.0f, 1.0f))));
}

void WriteMesh(const std::filesystem::path& file) {
  const Mesh body = MakeM200(/*orange=*/true).body;
  PeerMesh mesh;
  for (std::size_t i = 0; i < body.positions.size(); ++i) {
    const Eigen::Vector3f &p = body.positions[i], &n = body.normals[i], &c = body.base_colours[i];
    mesh.positions.push_back({p.x(), p.y(), p.z()});
    mesh.normals.push_back({n.x(), n.y(), n.z()});
    mesh.colours.push_back({ByteFrom(c.x()), ByteFrom(c.y()), ByteFrom(c.z())});
  }
  for (const auto& t : body.triangles) mesh.triangles.push_back({t[0], t[1], t[2]});
  WritePeerMesh(mesh, file);
  fmt::print("{} triangles\n", mesh.triangles.size());
}

void WritePanorama(const std::filesystem::path& file) {
  const auto environment = MakeEnvironment(BenchmarkScenario().environment);
  cv::Mat image(kPanoramaWidth_px / 2, kPanoramaWidth_px, CV_8UC3);
  const double deg_per_px = 360.0 / kPanoramaWidth_px;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const Eigen::Vector3f light = environment->Radiance(
          DirectionFromAngles(180 - (x + 0.5) * deg_per_px, 90 - (y + 0.5) * deg_per_px),
          static_cast<float>(2 * EIGEN_PI / kPanoramaWidth_px));
      image.at<cv::Vec3b>(y, x) = {ByteFrom(light.z()), ByteFrom(light.y()), ByteFrom(light.x())};
    }
  }
  cv::imwrite(file.string(), image);
}

void WriteOurImages(const std::filesystem::path& folder) {
  StereoRenderer renderer(BenchmarkScenario(), {0}, 1);
  for (int pose = 0; pose < kBenchmarkPoses; pose += 5) {
    WriteImage(renderer.Render(BenchmarkWorld(pose), pose)[0].left,
               folder / fmt::format("ours_{:02}.png", pose));
  }
}

}  // namespace
}  // namespace windhover

int main(int argc, char** argv) {
  using namespace windhover;
  std::string folder;
  CLI::App app("writes what the peers draw", "peer_inputs");
  app.add_option("FOLDER", folder, "folder to write to")->required();
  return RunProgram(app, argc, argv, [&] {
    std::filesystem::create_directories(folder);
    WriteMesh(std::filesystem::path(folder) / "aircraft.ply");
    WritePanorama(std::filesystem::path(folder) / "panorama.png");
    WriteOurImages(folder);
  });
}
