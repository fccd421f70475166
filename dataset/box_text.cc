#include "dataset/box_text.h"

#include <fmt/format.h>

namespace windhover {

BoxEdges EdgesOf(const image_box_t& box) {
  const double x_px = box.x_px + 0.5, y_px = box.y_px + 0.5;
  return {x_px - box.w_px / 2, y_px - box.h_px / 2, x_px + box.w_px / 2, y_px + box.h_px / 2};
}

std::string BoxInShares(const image_box_t& box, int width_px, int height_px) {
  return fmt::format("{:.7f} {:.7f} {:.7f} {:.7f}", (box.x_px + 0.5) / width_px,
                     (box.y_px + 0.5) / height_px, box.w_px / width_px, box.h_px / height_px);
}

std::string VisibleBoxes(const LabelledPair& pair, target_view_t target_annotation_t::*side) {
  const auto [width_px, height_px] = pair.flight.scenario.rig.calibrated.image;
  std::string text;
  for (const target_annotation_t& target : pair.annotation.targets) {
    const image_box_t& box = (target.*side).visible;
    if (box.w_px > 0) text += "0 " + BoxInShares(box, width_px, height_px) + '\n';
  }
  return text;
}

}  // namespace windhover
