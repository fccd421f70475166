#include "render/target_pass.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/mesh_builder.h"
#include "render/target_motion.h"

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

// The vertices of a projected mesh's triangles whose front faces the camera.
std::vector<bool> FacingVertices(const ProjectedMesh& mesh) {
  std::vector<bool> facing(mesh.x_px.size());
  const auto &x = mesh.x_px, &y = mesh.y_px;
  for (const auto& [a, b, c] : mesh.SeenTriangles()) {
    // A little beyond edge-on, as places will be rounded.
    constexpr double kMargin_px2 = 0.1;
    const double area = (x[c] - x[a]) * (y[b] - y[a]) - (x[b] - x[a]) * (y[c] - y[a]);
    if (area > -kMargin_px2) facing[a] = facing[b] = facing[c] = true;
  }
  return facing;
}

// How opaque the propellers' discs are from the camera, one a vertex; 0 where only back faces are.
std::vector<float> DiscAlphas(const ShadedTarget& target, const ProjectedMesh& discs,
                              const RowPoses& X_CB, const RotorTurning& turning) {
  constexpr double kSpread_rad = 2 * std::numbers::pi / kDiscSectors;
  const std::vector<Propeller>& propellers = target.model->Propellers();
  const std::vector<Eigen::Vector3f>& places = target.level->discs.positions;
  const Eigen::Vector3d camera_B_m = X_CB.Middle().inverse().translation();
  const std::vector<bool> facing = FacingVertices(discs);
  std::vector<float> alphas(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!facing[i]) continue;
    const Eigen::Vector3d p_B_m = places[i].cast<double>();
    alphas[i] =
        static_cast<float>(BladeCoverage(propellers[i * propellers.size() / places.size()], turning,
                                         p_B_m, (p_B_m - camera_B_m).normalized(), kSpread_rad));
  }
  return alphas;
}

TargetDrawing DrawingOf(const ShadedTarget& target, const AnyCamera& camera, const RowPoses& pose,
                        const RotorTurning& turning) {
  TargetDrawing drawing{&target,
                        Project(target.level->body, camera, pose),
                        Project(target.level->discs, camera, pose),
                        {},
                        {}};
  drawing.disc_alphas = DiscAlphas(target, drawing.discs, pose, turning);
  drawing.bounds = drawing.body.bounds;
  drawing.bounds.Extend(drawing.discs.bounds);
  return drawing;
}

std::vector<SampleShift> InSamples(const DrawnPart& part, int samples_per_px) {
  std::vector<SampleShift> shifts;
  for (const Eigen::Vector2d& shift_px : part.shifts_px) {
    shifts.push_back({static_cast<int>(std::lround(shift_px.x() * samples_per_px)),
                      static_cast<int>(std::lround(shift_px.y() * samples_per_px))});
  }
  return shifts;
}

}  // namespace

// A layer in the making.
struct TargetPass::Gathering {
  LayerSum sum;
  int samples_per_px;
  PixelRect region;  // Of the image, and as far around it as the drawing's samples are moved.
  std::vector<SampleShift> shifts;  // None: only the cover is wanted.
  const SampleShift* middle;        // Where the cover is taken from; null: from nowhere.
};

TargetPass::TargetPass(std::unique_ptr<TargetCanvas> canvas, double max_blur_px)
    : canvas_(std::move(canvas)), max_blur_px_(max_blur_px) {}
TargetPass::TargetPass(std::unique_ptr<GlContext> context, double max_blur_px)
    : TargetPass(MakeGlCanvas(std::move(context)), max_blur_px) {}
TargetPass::~TargetPass() = default;

std::unique_ptr<TargetPass> MakeTargetPass(Rasteriser rasteriser, double max_blur_px) {
  return rasteriser == Rasteriser::kNative
             ? std::make_unique<TargetPass>(MakeNativeCanvas(), max_blur_px)
             : std::make_unique<TargetPass>(MakeOsMesaContext(), max_blur_px);
}

TargetLayer TargetPass::Draw(const ShadedTarget& target, const AnyCamera& camera, int width_px,
                             int height_px, std::span<const RowPoses> X_CB,
                             const RotorTurning& rotors) {
  const std::vector<DrawnPart> parts =
      DivideExposure(target.level->box, camera, X_CB, max_blur_px_);
  std::vector<TargetDrawing> drawings;
  ImageBounds bounds;
  double shift_px = 0;
  for (const DrawnPart& part : parts) {
    drawings.push_back(DrawingOf(target, camera, X_CB[part.drawn],
                                 rotors.Part(part.first, part.shifts_px.size(), X_CB.size())));
    bounds.Extend(drawings.back().bounds);
    shift_px = std::max(shift_px, part.LargestShift_px());
  }
  const int samples_per_px = SamplesFor(bounds.Extent_px(), parts.size());
  bounds.Grow(shift_px);
  const PixelRect roi = bounds.Within(width_px, height_px, 0);
  if (roi.IsEmpty()) return {};
  Gathering gathering{{roi, samples_per_px}, samples_per_px, {}, {}, nullptr};
  const bool is_one = parts.size() == 1;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double reach_px = parts[i].LargestShift_px();
    gathering.shifts = InSamples(parts[i], samples_per_px);
    gathering.middle = is_one ? &gathering.shifts[X_CB.size() / 2] : nullptr;
    gathering.region = drawings[i].bounds.Within(
        width_px, height_px, reach_px > 0 ? static_cast<int>(std::ceil(reach_px)) + 1 : 0);
    Gather(drawings[i], &gathering);
  }
  // A part's blades are not all that is seen of them.
  if (!is_one) {
    const SampleShift unmoved{0, 0};
    gathering.region = roi;
    gathering.shifts.clear();
    gathering.middle = &unmoved;
    Gather(DrawingOf(target, camera, X_CB[X_CB.size() / 2], rotors), &gathering);
  }
  return std::move(gathering.sum).Mean(X_CB.size());
}

void TargetPass::Gather(const TargetDrawing& drawing, Gathering* gathering) {
  const PixelRect& region = gathering->region;
  if (region.IsEmpty()) return;
  const TargetCanvas::TileLimits limits = canvas_->Limits();
  const int s = gathering->samples_per_px;
  const int width = std::min(limits.columns / s, region.width);
  const int height = std::clamp(limits.samples / (s * s * width), 1, limits.rows / s);
  canvas_->Load(drawing, s);
  for (int y = 0; y < region.height; y += height) {
    for (int x = 0; x < region.width; x += width) {
      const PixelRect shown{region.x0 + x, region.y0 + y, std::min(width, region.width - x),
                            std::min(height, region.height - y)};
      canvas_->Draw(shown);
      if (gathering->middle != nullptr) {
        canvas_->ReadCover(&cover_);
        gathering->sum.SetCover(shown, cover_, *gathering->middle);
      }
      if (gathering->shifts.empty()) continue;
      if (gathering->shifts.size() == 1) {
        canvas_->AddPixels(gathering->sum.PixelsAt(shown.x0, shown.y0), gathering->sum.Stride());
        continue;
      }
      boxes_.Set(canvas_->Samples(), shown, s);
      gathering->sum.Add(boxes_, gathering->shifts);
    }
  }
}

}  // namespace windhover
