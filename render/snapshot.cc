#include "render/snapshot.h"

#include <cmath>
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/geometry/rotation.h"
#include "common/time/sim_time.h"
#include "render/render_node.h"

namespace windhover {
namespace {

using nlohmann::ordered_json;

ordered_json JsonFrom(const image_box_t& box) {
  return {{"x_px", box.x_px}, {"y_px", box.y_px}, {"w_px", box.w_px}, {"h_px", box.h_px}};
}

ordered_json JsonFrom(const target_view_t& view) {
  return {{"in_front", view.in_front != 0}, {"visible", JsonFrom(view.visible)},
          {"full", JsonFrom(view.full)},    {"centre_px", {view.centre_px[0], view.centre_px[1]}},
          {"occlusion", view.occlusion},    {"truncation", view.truncation}};
}

ordered_json JsonFrom(const annotation_t& annotation) {
  ordered_json targets = ordered_json::array();
  for (const target_annotation_t& target : annotation.targets) {
    targets.push_back({{"target_id", target.target_id},
                       {"p_RT_m", {target.p_RT_m[0], target.p_RT_m[1], target.p_RT_m[2]}},
                       {"range_m", target.range_m},
                       {"depth_m", target.depth_m},
                       {"left", JsonFrom(target.left)},
                       {"right", JsonFrom(target.right)}});
  }
  return {{"utime", annotation.utime},
          {"observer_id", annotation.observer_id},
          {"targets", std::move(targets)}};
}

}  // namespace

world_truth_t StartWorld(const Scenario& scenario, double t_s) {
  world_truth_t world{};
  world.utime = UtimeFromSeconds(t_s);
  for (const Aircraft& aircraft : scenario.aircraft) {
    uav_truth_t uav{};
    uav.id = aircraft.self.id;
    std::copy(aircraft.position_m.begin(), aircraft.position_m.end(), uav.p_WB_m);
    uav.qw = std::cos(RadFromDeg(aircraft.yaw_deg) / 2);
    uav.qz = std::sin(RadFromDeg(aircraft.yaw_deg) / 2);
    world.uavs.push_back(uav);
  }
  world.n_uavs = static_cast<std::int32_t>(world.uavs.size());
  return world;
}

world_truth_t ReadWorld(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::vector<char> content{std::istreambuf_iterator<char>(stream), {}};
  try {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(content.data());
    return Decode<world_truth_t>({bytes, content.size()});
  } catch (const std::runtime_error& error) {
    throw ConfigError(
        fmt::format("{}: is no encoded world_truth_t: {}", file.string(), error.what()));
  }
}

void WriteSnapshot(const Scenario& scenario, const world_truth_t& world, int threads,
                   const std::filesystem::path& out) {
  const std::vector<int> observers = OwnedObservers(scenario, {});
  if (observers.empty()) throw ConfigError("snapshot: no aircraft of the scenario carries a rig");
  StereoRenderer renderer(scenario, {observers.front()}, threads);
  const auto tick =
      static_cast<int>(std::lround(SecondsFromUtime(world.utime) * scenario.frame_rate_hz));
  std::vector<RenderedPair> pairs = renderer.Render(world, tick);
  if (scenario.exposure.auto_exposure.mode != AutoExposureMode::kOff) {
    constexpr int kSettlingFrames = 20;
    for (int i = 0; i < kSettlingFrames; ++i) pairs = renderer.Render(world, tick);
  }
  std::filesystem::create_directories(out);
  const FrameFormat format = FrameFormatOf(scenario.sensor);
  WriteImage(AsReceived(pairs[0].left, format), out / "left.png");
  WriteImage(AsReceived(pairs[0].right, format), out / "right.png");
  std::ofstream labels(out / "labels.json");
  labels << JsonFrom(pairs[0].annotation).dump(2) << '\n';
  labels.close();
  if (!labels)
    throw std::runtime_error(fmt::format("{}: cannot be written", (out / "labels.json").string()));
}

}  // namespace windhover
