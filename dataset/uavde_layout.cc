#include "dataset/uavde_layout.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "common/config/enum_name.h"
#include "common/file/whole_file.h"
#include "dataset/box_text.h"
#include "eval/samples.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDetected = "inference/detected_labels";

// Their code puts the side before the last of the fields between dashes.
std::string NameFor(const PairId& id, const char* side) {
  return fmt::format("windhover-{}-{}-{:05}", id.flight, side, id.tick);
}

std::string IdOf(const PairId& id) {
  return fmt::format("windhover-{}-{:05}.txt\n", id.flight, id.tick);
}

/// The rows of one camera's file of detections, as text and as numbers.
struct Rows {
  std::string text;
  UavdeRows numbers;
};

// Best last. The numbers are those that the text is read as.
Rows RowsOf(const LabelledPair& pair, image_box_t stereo_box_t::*side) {
  const auto [width_px, height_px] = pair.flight.scenario.rig.calibrated.image;
  std::vector<stereo_box_t> boxes = pair.detections.boxes;
  std::stable_sort(boxes.begin(), boxes.end(),
                   [](const auto& a, const auto& b) { return a.score < b.score; });
  Rows rows;
  for (const stereo_box_t& box : boxes) {
    const std::string line =
        fmt::format("0 {} {:.6f}", BoxInShares(box.*side, width_px, height_px), box.score);
    rows.text += line + '\n';
    std::istringstream in(line);
    std::array<float, 6>& row = rows.numbers.emplace_back();
    double value = 0;
    for (float& number : row) number = in >> value ? static_cast<float>(value) : 0;
  }
  return rows;
}

// Which target the row that counts is of: the best detection's, if it is the nearest in view.
std::optional<std::size_t> Detected(const LabelledPair& pair) {
  const auto& targets = pair.annotation.targets;
  std::optional<std::size_t> nearest;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (!InViewOfBoth(targets[i])) continue;
    if (!nearest || targets[i].range_m < targets[*nearest].range_m) nearest = i;
  }
  if (!nearest || pair.detections.boxes.empty()) return std::nullopt;
  const auto of = Associate(pair.detections, pair.annotation);
  std::size_t best = 0;
  for (std::size_t i = 0; i < of.size(); ++i) {
    // The last of equals, as rows are sorted.
    if (pair.detections.boxes[i].score >= pair.detections.boxes[best].score) best = i;
  }
  return of[best] == nearest ? nearest : std::nullopt;
}

}  // namespace

UavdeLayout::Lists::Lists(const fs::path& folder, const std::string& split)
    : distances(WithFolders(folder / "data" / split / "annotations.csv")),
      exact(folder / "data" / split / "annotations_exact.csv"),
      ids(folder / "data" / (split + "_no_prefix.txt")),
      tuples(folder / "data" / (split + ".npy")) {
  distances.out() << ",distance\n";
  exact.out() << ",distance\n";
}

StereoFiles UavdeLayout::ImageFiles(const PairId& id) const {
  const fs::path images = fs::path("data") / NameOf(id.split) / "image";
  return {images / (NameFor(id, "Left") + ".jpg"), images / (NameFor(id, "Right") + ".jpg")};
}

void UavdeLayout::Add(const LabelledPair& pair) {
  const std::string split = NameOf(pair.id.split);
  Lists& lists = lists_.try_emplace(pair.id.split, folder_, split).first->second;
  const fs::path base = folder_ / "data" / split;
  const std::string left_name = NameFor(pair.id, "Left"), right_name = NameFor(pair.id, "Right");
  ReplaceFile(WithFolders(base / "label" / (left_name + ".txt")),
              VisibleBoxes(pair, &target_annotation_t::left));
  ReplaceFile(base / "label" / (right_name + ".txt"),
              VisibleBoxes(pair, &target_annotation_t::right));
  const auto target = Detected(pair);
  if (!target) return;
  const auto reference_m = pair.Reference_m(*target);
  if (!reference_m) return;
  const Rows left = RowsOf(pair, &stereo_box_t::left), right = RowsOf(pair, &stereo_box_t::right);
  ReplaceFile(WithFolders(base / kDetected / (left_name + ".txt")), left.text);
  ReplaceFile(base / kDetected / (right_name + ".txt"), right.text);
  lists.distances.out() << fmt::format("{}.jpg,{}\n", left_name, *reference_m);
  lists.exact.out() << fmt::format("{}.jpg,{}\n", left_name, pair.Target(*target).range_m);
  lists.ids.out() << IdOf(pair.id);
  lists.tuples.Add(left.numbers, right.numbers, static_cast<float>(*reference_m), IdOf(pair.id));
}

void UavdeLayout::Finish() {
  for (auto& [split, lists] : lists_) {
    lists.distances.Commit();
    lists.exact.Commit();
    lists.ids.Commit();
    lists.tuples.Finish();
  }
}

}  // namespace windhover
