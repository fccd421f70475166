#include "render/target_pass.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "render/mesh_builder.h"
#include "render/target_canvas.h"

namespace windhover {
namespace {

// Samples a pixel along each axis, so that a silhouette's centroid is true to a few hundredths
// of a pixel at every size (docs/sources.md). Images drawn anew for each sub-exposure are
// samples too.
int SamplesFor(double extent_px, std::size_t drawings) {
  const int alone = extent_px < 64 ? 8 : extent_px < 128 ? 4 : extent_px < 256 ? 3 : 2;
  const double shared = std::ceil(alone / std::sqrt(static_cast<double>(drawings)));
  return std::max(2, static_cast<int>(shared));
}

// From image coordinates to a canvas that shows `rect`. Depth is affine in 1 / Z, which is
// affine in the image, so that interpolation between vertices is exact.
class CanvasMap {
 public:
  CanvasMap(const PixelRect& rect, const ImageBounds& bounds) : rect_(rect) {
    const double margin = 1e-3 * bounds.inverse_near;
    near_ = bounds.inverse_near + margin;
    far_ = std::max(bounds.inverse_far - margin, 0.0);
  }

  CanvasVertex Vertex(const ImageVertex& v, const Eigen::Vector3f& light, float alpha) const {
    if (!v.is_valid) return {};
    return {static_cast<float>(2 * (v.x_px - rect_.x0 + 0.5) / rect_.width - 1),
            static_cast<float>(2 * (v.y_px - rect_.y0 + 0.5) / rect_.height - 1),
            static_cast<float>((near_ + far_ - 2 * v.inverse_depth) / (near_ - far_)),
            light.x() * alpha,
            light.y() * alpha,
            light.z() * alpha,
            alpha};
  }

 private:
  PixelRect rect_;
  double near_, far_;
};

// `alphas`: one a vertex, or none where all is opaque.
std::vector<CanvasVertex> OnCanvas(const ProjectedMesh& mesh,
                                   const std::vector<Eigen::Vector3f>& light,
                                   const std::vector<float>& alphas, const CanvasMap& map) {
  std::vector<CanvasVertex> vertices;
  vertices.reserve(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    vertices.push_back(map.Vertex(mesh.vertices[i], light[i], alphas.empty() ? 1 : alphas[i]));
  }
  return vertices;
}

// How opaque the propellers' discs are from the camera, one a vertex.
std::vector<float> DiscAlphas(const ShadedTarget& target, const RowPoses& X_CB,
                              const RotorTurning& turning) {
  constexpr double kSpread_rad = 2 * std::numbers::pi / kDiscSectors;
  const std::vector<Propeller>& propellers = target.model->Propellers();
  const std::vector<Eigen::Vector3f>& places = target.level->discs.positions;
  const Eigen::Vector3d camera_B_m = X_CB.Middle().inverse().translation();
  std::vector<float> alphas;
  alphas.reserve(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector3d p_B_m = places[i].cast<double>();
    alphas.push_back(
        static_cast<float>(BladeCoverage(propellers[i * propellers.size() / places.size()], turning,
                                         p_B_m, (p_B_m - camera_B_m).normalized(), kSpread_rad)));
  }
  return alphas;
}

TargetLayer::Sample SampleOf(std::uint16_t coverage) {
  // Black blades before white clouds that cover 2 % change an image by five of 255 grey levels.
  constexpr std::uint16_t kVisible = 1311;
  if (coverage < kVisible) return TargetLayer::Sample::kEmpty;
  return coverage > 60000 ? TargetLayer::Sample::kOpaque : TargetLayer::Sample::kTranslucent;
}

struct SampleShift {
  int columns = 0, rows = 0;
};

// One pose of the target, projected, and by how many samples its image is moved for each of the
// sub-exposures that it stands for.
struct Drawing {
  ProjectedMesh body, discs;
  std::vector<float> disc_alphas;
  std::vector<SampleShift> shifts;
};

// How the image of a target moves during an exposure: by `shifts_px` as a whole, and by up to
// `residual_px` otherwise.
struct ImageMotion {
  std::vector<Eigen::Vector2d> shifts_px;
  double residual_px = 0;
  double LargestShiftPx() const {
    double largest = 0;
    for (const Eigen::Vector2d& shift : shifts_px) largest = std::max(largest, shift.norm());
    return largest;
  }
};

std::vector<SampleShift> InSamples(const ImageMotion& motion, int samples_per_px) {
  std::vector<SampleShift> shifts;
  for (const Eigen::Vector2d& shift_px : motion.shifts_px) {
    shifts.push_back({static_cast<int>(std::lround(shift_px.x() * samples_per_px)),
                      static_cast<int>(std::lround(shift_px.y() * samples_per_px))});
  }
  return shifts;
}

// Relative to the middle pose. Infinite if the lens does not see all of the target.
ImageMotion MotionOf(const Eigen::AlignedBox3f& box, const AnyCamera& camera,
                     std::span<const RowPoses> X_CB) {
  constexpr int kCorners = 8;
  const RowPoses& X_CB_middle = X_CB[X_CB.size() / 2];
  ImageMotion motion;
  for (const RowPoses& pose : X_CB) {
    std::vector<Eigen::Vector2d> moves;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (int i = 0; i < kCorners; ++i) {
      const Eigen::Vector3d p_B =
          box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(i)).cast<double>();
      const auto from = ProjectByRows(camera, X_CB_middle, p_B);
      const auto to = ProjectByRows(camera, pose, p_B);
      if (!from || !to) return {{}, std::numeric_limits<double>::infinity()};
      moves.push_back(*to - *from);
      mean += moves.back() / kCorners;
    }
    motion.shifts_px.push_back(mean);
    for (const Eigen::Vector2d& move : moves) {
      motion.residual_px = std::max(motion.residual_px, (move - mean).norm());
    }
  }
  return motion;
}

// Gathers samples of tiles and sub-exposures into a layer.
class LayerSum {
 public:
  LayerSum(const PixelRect& roi, int samples_per_px) {
    layer_.roi = roi;
    layer_.samples_per_px = samples_per_px;
    const auto pixels = static_cast<std::size_t>(roi.width) * static_cast<std::size_t>(roi.height);
    sums_.resize(pixels * 4);
    layer_.samples.resize(pixels * static_cast<std::size_t>(samples_per_px * samples_per_px));
  }

  /// Adds `tile`, taken from a canvas that shows it with `margin_px` around, moved by `shift`.
  void Add(const PixelRect& tile, int margin_px, const SampleShift& shift,
           const std::vector<TargetCanvas::Pixel>& canvas, bool is_middle) {
    const int s = layer_.samples_per_px, x_offset = tile.x0 - layer_.roi.x0;
    const int stride = (tile.width + 2 * margin_px) * s;
    for (int y = 0; y < tile.height * s; ++y) {
      const TargetCanvas::Pixel* sample =
          canvas.data() + static_cast<std::ptrdiff_t>(y + margin_px * s - shift.rows) * stride +
          margin_px * s - shift.columns;
      const int row = tile.y0 - layer_.roi.y0 + y / s;
      std::uint32_t* sum =
          sums_.data() + 4 * (static_cast<std::ptrdiff_t>(row) * layer_.roi.width + x_offset);
      TargetLayer::Sample* mask =
          layer_.samples.data() +
          (static_cast<std::ptrdiff_t>(tile.y0 - layer_.roi.y0) * s + y) * layer_.roi.width * s +
          x_offset * s;
      for (int x = 0; x < tile.width; ++x, sum += 4) {
        for (int i = 0; i < s; ++i, ++sample, ++mask) {
          if ((*sample)[3] == 0) continue;  // Most samples.
          for (std::size_t c = 0; c < 4; ++c) sum[c] += (*sample)[c];
          if (is_middle) *mask = SampleOf((*sample)[3]);
        }
      }
    }
  }

  TargetLayer Mean(std::size_t exposures) && {
    const auto count = static_cast<std::uint32_t>(
        exposures * static_cast<std::size_t>(layer_.samples_per_px * layer_.samples_per_px));
    layer_.pixels.resize(sums_.size() / 4);
    for (std::size_t i = 0; i < layer_.pixels.size(); ++i) {
      for (std::size_t c = 0; c < 4; ++c) {
        layer_.pixels[i][c] = static_cast<std::uint16_t>((sums_[4 * i + c] + count / 2) / count);
      }
    }
    return std::move(layer_);
  }

 private:
  TargetLayer layer_;
  std::vector<std::uint32_t> sums_;  ///< Below 2^16 · 8² samples · 256 exposures = 2^30.
};

}  // namespace

TargetLayer::Sample TargetLayer::SampleAt(double x_px, double y_px) const {
  const auto column = static_cast<std::int64_t>(std::floor((x_px + 0.5 - roi.x0) * samples_per_px));
  const auto row = static_cast<std::int64_t>(std::floor((y_px + 0.5 - roi.y0) * samples_per_px));
  const std::int64_t columns = std::int64_t{roi.width} * samples_per_px;
  const std::int64_t rows = std::int64_t{roi.height} * samples_per_px;
  if (column < 0 || row < 0 || column >= columns || row >= rows) return Sample::kEmpty;
  return samples[static_cast<std::size_t>(row * columns + column)];
}

struct TargetPass::Gl {
  explicit Gl(std::unique_ptr<GlContext> context) : canvas(std::move(context)) {}

  void DrawTile(const ShadedTarget& target, const Drawing& drawing, const PixelRect& tile,
                const ImageBounds& bounds, int samples_per_px) {
    using Surface = TargetCanvas::Surface;
    const CanvasMap map(tile, bounds);
    canvas.Begin(tile.width * samples_per_px, tile.height * samples_per_px);
    canvas.Draw(target.model->IsWatertight() ? Surface::kClosed : Surface::kOpen,
                OnCanvas(drawing.body, target.body_light, {}, map), drawing.body.triangles);
    canvas.Draw(Surface::kTranslucent,
                OnCanvas(drawing.discs, target.disc_light, drawing.disc_alphas, map),
                drawing.discs.triangles);
    canvas.Read(&samples);
  }

  /// Mean of all drawings and their shifts, within `roi`; shifts stay below `margin_px`.
  TargetLayer Gather(const ShadedTarget& target, std::span<const Drawing> drawings,
                     const ImageBounds& bounds, const PixelRect& roi, int samples_per_px,
                     int margin_px);

  TargetCanvas canvas;
  std::vector<TargetCanvas::Pixel> samples;
};

TargetPass::TargetPass(std::unique_ptr<GlContext> context, double max_blur_px)
    : gl_(std::make_unique<Gl>(std::move(context))), max_blur_px_(max_blur_px) {}
TargetPass::~TargetPass() = default;

TargetLayer TargetPass::Draw(const ShadedTarget& target, const AnyCamera& camera, int width_px,
                             int height_px, std::span<const RowPoses> X_CB,
                             const RotorTurning& rotors) {
  constexpr double kMaxShift_px = 128;
  const ImageMotion motion = MotionOf(target.level->box, camera, X_CB);
  // A short exposure moves the image as a whole: one drawing serves all sub-exposures. What is
  // left goes from -residual to +residual, so that its mean is in the drawing.
  const bool is_shift =
      2 * motion.residual_px <= max_blur_px_ && motion.LargestShiftPx() <= kMaxShift_px;
  const std::span<const RowPoses> drawn = is_shift ? X_CB.subspan(X_CB.size() / 2, 1) : X_CB;
  std::vector<Drawing> drawings;
  ImageBounds bounds;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    drawings.push_back({Project(target.level->body, camera, drawn[i]),
                        Project(target.level->discs, camera, drawn[i]),
                        DiscAlphas(target, drawn[i], rotors.Part(i, drawn.size())),
                        {SampleShift{}}});
    bounds.Extend(drawings.back().body);
    bounds.Extend(drawings.back().discs);
  }
  const int samples_per_px = SamplesFor(bounds.Extent_px(), drawn.size());
  int margin_px = 0;
  if (is_shift) {
    drawings[0].shifts = InSamples(motion, samples_per_px);
    margin_px = static_cast<int>(std::ceil(motion.LargestShiftPx())) + 1;
    bounds.Grow(motion.LargestShiftPx());
  }
  const PixelRect roi = bounds.Within(width_px, height_px);
  if (roi.IsEmpty()) return {};
  return gl_->Gather(target, drawings, bounds, roi, samples_per_px,
                     X_CB.size() == 1 ? 0 : margin_px);
}

TargetLayer TargetPass::Gl::Gather(const ShadedTarget& target, std::span<const Drawing> drawings,
                                   const ImageBounds& bounds, const PixelRect& roi,
                                   int samples_per_px, int margin_px) {
  const int tile_px = TargetCanvas::kMaxSize / samples_per_px - 2 * margin_px;
  LayerSum sum(roi, samples_per_px);
  std::size_t exposures = 0;
  for (const Drawing& drawing : drawings) exposures += drawing.shifts.size();
  for (int y = 0; y < roi.height; y += tile_px) {
    for (int x = 0; x < roi.width; x += tile_px) {
      const PixelRect tile{roi.x0 + x, roi.y0 + y, std::min(tile_px, roi.width - x),
                           std::min(tile_px, roi.height - y)};
      const PixelRect shown{tile.x0 - margin_px, tile.y0 - margin_px, tile.width + 2 * margin_px,
                            tile.height + 2 * margin_px};
      std::size_t exposure = 0;
      for (const Drawing& drawing : drawings) {
        DrawTile(target, drawing, shown, bounds, samples_per_px);
        for (const SampleShift& shift : drawing.shifts) {
          sum.Add(tile, margin_px, shift, samples, exposure++ == exposures / 2);
        }
      }
    }
  }
  return std::move(sum).Mean(exposures);
}

}  // namespace windhover
