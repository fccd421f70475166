#include "render/annotator.h"

#include <algorithm>
#include <cstring>

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

using Sample = TargetLayer::Sample;

bool Overlap(const PixelRect& a, const PixelRect& b) {
  return a.x0 < b.x0 + b.width && b.x0 < a.x0 + a.width && a.y0 < b.y0 + b.height &&
         b.y0 < a.y0 + a.height;
}

// Samples of a layer: how many show something, how many of them a nearer target hides, and the box
// around the others.
struct Seen {
  Eigen::AlignedBox2i box;
  std::int64_t all = 0, hidden = 0;
};

// How many samples from `sample` on are empty, of at most `count`; eight at a time.
int CountEmpty(const Sample* sample, int count) {
  int n = 0;
  for (std::uint64_t eight = 0; n + 8 <= count; n += 8) {
    std::memcpy(&eight, sample + n, sizeof eight);
    if (eight != 0) break;
  }
  while (n < count && sample[n] == Sample::kEmpty) ++n;
  return n;
}

// Where nothing is in front; `all` is not counted.
Seen SeenAlone(const TargetLayer& layer) {
  const int columns = layer.roi.width * layer.samples_per_px;
  Seen seen;
  for (int row = 0; row < layer.roi.height * layer.samples_per_px; ++row) {
    const Sample* sample = layer.samples.data() + static_cast<std::ptrdiff_t>(row) * columns;
    const int first = CountEmpty(sample, columns);
    if (first == columns) continue;
    int last = columns - 1;
    while (sample[last] == Sample::kEmpty) --last;
    seen.box.extend(Eigen::Vector2i(first, row));
    seen.box.extend(Eigen::Vector2i(last, row));
  }
  return seen;
}

Seen SeenBehind(const TargetLayer& layer, const std::vector<const TargetLayer*>& nearer) {
  const int s = layer.samples_per_px, columns = layer.roi.width * s;
  Seen seen;
  for (int row = 0; row < layer.roi.height * s; ++row) {
    const Sample* sample = layer.samples.data() + static_cast<std::ptrdiff_t>(row) * columns;
    for (int column = CountEmpty(sample, columns); column < columns; ++column) {
      if (sample[column] == Sample::kEmpty) continue;
      ++seen.all;
      const double x_px = layer.roi.x0 + (column + 0.5) / s - 0.5;
      const double y_px = layer.roi.y0 + (row + 0.5) / s - 0.5;
      const bool is_hidden = std::any_of(
          nearer.begin(), nearer.end(),
          [&](const TargetLayer* other) { return other->SampleAt(x_px, y_px) == Sample::kOpaque; });
      seen.hidden += is_hidden;
      if (!is_hidden) seen.box.extend(Eigen::Vector2i(column, row));
    }
  }
  return seen;
}

}  // namespace

target_view_t ViewFromGeometry(const Outline& outline, const RowPoses& X_CB,
                               const AnyCamera& camera, int width_px, int height_px) {
  target_view_t view{};
  const auto centre_px = ProjectByRows(camera, X_CB, Eigen::Vector3d::Zero());
  if (!centre_px) return view;
  view.in_front = 1;
  view.centre_px[0] = centre_px->x();
  view.centre_px[1] = centre_px->y();
  const Eigen::AlignedBox2d box = outline.BoxThrough(camera, X_CB);
  if (box.isEmpty()) return view;
  view.full = BoxFromEdges(box.min().x(), box.min().y(), box.max().x(), box.max().y());
  view.visible = CutAtBorders(view.full, width_px, height_px);
  const double area = view.full.w_px * view.full.h_px;
  view.truncation = area > 0 ? 1 - view.visible.w_px * view.visible.h_px / area : 0;
  return view;
}

void SetVisibility(std::span<const TargetLayer> layers, std::size_t i, target_view_t* view) {
  const TargetLayer& layer = layers[i];
  std::vector<const TargetLayer*> nearer;
  for (const TargetLayer& other : layers.subspan(i + 1)) {
    if (Overlap(layer.roi, other.roi)) nearer.push_back(&other);
  }
  const Seen seen = nearer.empty() ? SeenAlone(layer) : SeenBehind(layer, nearer);
  view->occlusion =
      seen.all > 0 ? static_cast<double>(seen.hidden) / static_cast<double>(seen.all) : 0;
  view->visible = {};
  if (seen.box.isEmpty()) return;
  const auto edge = [s = layer.samples_per_px](int origin_px, int index) {
    return origin_px + static_cast<double>(index) / s - 0.5;
  };
  view->visible = BoxFromEdges(
      edge(layer.roi.x0, seen.box.min().x()), edge(layer.roi.y0, seen.box.min().y()),
      edge(layer.roi.x0, seen.box.max().x() + 1), edge(layer.roi.y0, seen.box.max().y() + 1));
}

}  // namespace windhover
