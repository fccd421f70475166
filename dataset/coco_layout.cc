#include "dataset/coco_layout.h"

#include <numeric>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/config/enum_name.h"
#include "dataset/box_text.h"
#include "render/dense_labels.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

std::string TypeOf(const LabelledPair& pair, std::size_t target) {
  const Aircraft& aircraft = pair.flight.scenario.aircraft[pair.PositionOf(target)];
  return NameOf(aircraft.type);
}

int AreaOf(const std::vector<int>& run_lengths) {
  int area = 0;
  for (std::size_t i = 1; i < run_lengths.size(); i += 2) area += run_lengths[i];
  return area;
}

ordered_json AttributesOf(const LabelledPair& pair, std::size_t i, const target_view_t& view) {
  const target_annotation_t& target = pair.Target(i);
  ordered_json attributes = {{"type", TypeOf(pair, i)},      {"target_id", target.target_id},
                             {"distance_m", target.range_m}, {"depth_m", target.depth_m},
                             {"occlusion", view.occlusion},  {"truncation", view.truncation}};
  const auto uwb = pair.pair.uwb_m.find(target.target_id);
  if (uwb != pair.pair.uwb_m.end()) attributes["distance_uwb_m"] = uwb->second;
  return attributes;
}

}  // namespace

std::vector<int> RunLengths(const std::vector<std::uint8_t>& mask, int width_px, int height_px,
                            std::uint8_t label) {
  std::vector<int> lengths = {0};
  bool inside = false;
  for (int x = 0; x < width_px; ++x) {
    for (int y = 0; y < height_px; ++y) {
      if ((mask[static_cast<std::size_t>(y * width_px + x)] == label) != inside) {
        inside = !inside;
        lengths.push_back(0);
      }
      ++lengths.back();
    }
  }
  return lengths;
}

CocoLayout::Lists::Lists(const fs::path& file)
    : waiting_file(file.string() + ".annotations"),
      json(WithFolders(file)),
      waiting(waiting_file, std::ios::binary) {
  const ordered_json info = {{"description", "synthetic stereo views of UAVs, made by windhover"},
                             {"version", "1.0"}};
  const ordered_json categories = {{{"id", 1}, {"name", "uav"}, {"supercategory", "vehicle"}}};
  json.out() << fmt::format(
      "{{\"info\": {},\n\"licenses\": [],\n\"categories\": {},\n\"images\": [", info.dump(),
      categories.dump());
}

StereoFiles CocoLayout::ImageFiles(const PairId& id) const {
  const fs::path folder = NameOf(id.split);
  return {folder / (StemOf(id) + "_left.jpg"), folder / (StemOf(id) + "_right.jpg")};
}

void CocoLayout::Add(const LabelledPair& pair) {
  const fs::path file =
      folder_ / "annotations" / fmt::format("instances_{}.json", NameOf(pair.id.split));
  Lists& lists = lists_.try_emplace(pair.id.split, file).first->second;
  const StereoFiles images = ImageFiles(pair.id);
  const DenseLabels dense =
      MakeDenseLabels(pair.flight.scenario, pair.geometry, 0, pair.pair.world);
  AddEye(pair, true, images.left.filename(), dense.left.mask, &lists);
  AddEye(pair, false, images.right.filename(), dense.right.mask, &lists);
}

void CocoLayout::AddEye(const LabelledPair& pair, bool is_left, const fs::path& image,
                        const std::vector<std::uint8_t>& mask, Lists* lists) {
  const auto [width_px, height_px] = pair.flight.scenario.rig.calibrated.image;
  const std::int64_t image_id = ++lists->n_images;
  const ordered_json about = {{"id", image_id},           {"file_name", image.string()},
                              {"width", width_px},        {"height", height_px},
                              {"flight", pair.id.flight}, {"camera", is_left ? "left" : "right"},
                              {"utime", pair.id.utime}};
  lists->json.out() << (image_id == 1 ? "\n" : ",\n") << about.dump();
  for (std::size_t i = 0; i < pair.annotation.targets.size(); ++i) {
    const target_view_t& view = is_left ? pair.Target(i).left : pair.Target(i).right;
    if (view.visible.w_px <= 0) continue;
    const BoxEdges box = EdgesOf(view.visible);
    const auto label = static_cast<std::uint8_t>(pair.PositionOf(i) + 1);
    const std::vector<int> lengths = RunLengths(mask, width_px, height_px, label);
    const std::int64_t id = ++lists->n_annotations;
    const ordered_json annotation = {
        {"id", id},
        {"image_id", image_id},
        {"category_id", 1},
        {"bbox", {box.left_px, box.top_px, view.visible.w_px, view.visible.h_px}},
        {"area", AreaOf(lengths)},
        {"iscrowd", 0},
        {"segmentation", {{"size", {height_px, width_px}}, {"counts", lengths}}},
        {"attributes", AttributesOf(pair, i, view)}};
    lists->waiting << (id == 1 ? "\n" : ",\n") << annotation.dump();
  }
}

void CocoLayout::Complete(Lists* lists) {
  lists->json.out() << "\n],\n\"annotations\": [";
  lists->waiting.close();
  if (!lists->waiting) {
    throw std::runtime_error(fmt::format("{}: cannot be written", lists->waiting_file.string()));
  }
  if (lists->n_annotations > 0) {
    lists->json.out() << std::ifstream(lists->waiting_file, std::ios::binary).rdbuf();
  }
  lists->json.out() << "\n]}\n";
  lists->json.Commit();
  fs::remove(lists->waiting_file);
}

void CocoLayout::Finish() {
  for (auto& [split, lists] : lists_) Complete(&lists);
}

}  // namespace windhover
