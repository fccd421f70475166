#include "render/annotator.h"

#include <algorithm>

namespace windhover {
namespace {

image_box_t BoxFromEdges(double left, double top, double right, double bottom) {
  image_box_t box{};
  if (right <= left || bottom <= top) return box;
  box.x_px = (left + right) / 2;
  box.y_px = (top + bottom) / 2;
  box.w_px = right - left;
  box.h_px = bottom - top;
  return box;
}

// The part of a box inside the image, whose outermost edges are half a pixel from the centres of
// the outermost pixels.
image_box_t CutAtBorders(const image_box_t& box, int width_px, int height_px) {
  return BoxFromEdges(std::max(box.x_px - box.w_px / 2, -0.5),
                      std::max(box.y_px - box.h_px / 2, -0.5),
                      std::min(box.x_px + box.w_px / 2, width_px - 0.5),
                      std::min(box.y_px + box.h_px / 2, height_px - 0.5));
}

}  // namespace

target_view_t ViewFromGeometry(const std::vector<Eigen::Vector3d>& outline_B, const RowPoses& X_CB,
                               const AnyCamera& camera, int width_px, int height_px) {
  target_view_t view{};
  const auto centre_px = ProjectByRows(camera, X_CB, Eigen::Vector3d::Zero());
  if (!centre_px) return view;
  view.in_front = 1;
  view.centre_px[0] = centre_px->x();
  view.centre_px[1] = centre_px->y();
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector3d& p_B : outline_B) {
    if (const auto q_px = ProjectByRows(camera, X_CB, p_B)) box.extend(*q_px);
  }
  if (box.isEmpty()) return view;
  view.full = BoxFromEdges(box.min().x(), box.min().y(), box.max().x(), box.max().y());
  view.visible = CutAtBorders(view.full, width_px, height_px);
  const double area = view.full.w_px * view.full.h_px;
  view.truncation = area > 0 ? 1 - view.visible.w_px * view.visible.h_px / area : 0;
  return view;
}

void SetVisibility(std::span<const TargetLayer> layers, std::size_t i, target_view_t* view) {
  using Sample = TargetLayer::Sample;
  const TargetLayer& layer = layers[i];
  const std::span<const TargetLayer> nearer = layers.subspan(i + 1);
  const int s = layer.samples_per_px;
  const int columns = layer.roi.width * s, rows = layer.roi.height * s;
  Eigen::AlignedBox2i box;
  std::int64_t all = 0, hidden = 0;
  for (int row = 0; row < rows; ++row) {
    const Sample* sample = layer.samples.data() + static_cast<std::ptrdiff_t>(row) * columns;
    for (int column = 0; column < columns; ++column) {
      if (sample[column] == Sample::kEmpty) continue;
      ++all;
      const double x_px = layer.roi.x0 + (column + 0.5) / s - 0.5;
      const double y_px = layer.roi.y0 + (row + 0.5) / s - 0.5;
      const bool is_hidden = std::any_of(
          nearer.begin(), nearer.end(),
          [&](const TargetLayer& other) { return other.SampleAt(x_px, y_px) == Sample::kOpaque; });
      hidden += is_hidden;
      if (!is_hidden) box.extend(Eigen::Vector2i(column, row));
    }
  }
  view->occlusion = all > 0 ? static_cast<double>(hidden) / static_cast<double>(all) : 0;
  view->visible = {};
  if (box.isEmpty()) return;
  const auto edge = [s](int origin_px, int index) {
    return origin_px + static_cast<double>(index) / s - 0.5;
  };
  view->visible =
      BoxFromEdges(edge(layer.roi.x0, box.min().x()), edge(layer.roi.y0, box.min().y()),
                   edge(layer.roi.x0, box.max().x() + 1), edge(layer.roi.y0, box.max().y() + 1));
}

}  // namespace windhover
