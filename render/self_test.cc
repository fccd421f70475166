#include "render/self_test.h"

#include <stdexcept>

#include "render/target_canvas.h"

namespace windhover {

std::string RunGlSelfTest() {
  std::unique_ptr<GlContext> context = MakeOsMesaContext();
  context->MakeCurrent();
  const std::string description = DescribeGl(*context);
  constexpr int kSize = 64;
  AircraftModel triangle;
  triangle.watertight = false;
  triangle.body.positions = {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  triangle.body.normals.assign(3, Eigen::Vector3f::UnitZ());
  triangle.body.base_colours.assign(3, Eigen::Vector3f::Ones());
  const PreparedModel model(triangle, 1);
  const DetailLevel& level = model.LevelFor(1e9, 1);
  const ShadedTarget target{&model, &level, {3, Eigen::Vector3f::Ones()}, {}};
  // The half of the canvas below its falling diagonal.
  constexpr double kFirst_px = -0.5, kLast_px = kSize - 0.5;
  TargetDrawing drawing;
  drawing.target = &target;
  drawing.body = {.x_px = {kFirst_px, kFirst_px, kLast_px},
                  .y_px = {kFirst_px, kLast_px, kLast_px},
                  .inverse_depth_per_m = {1, 1, 1},
                  .bounds = {kFirst_px, kLast_px, kFirst_px, kLast_px, 1, 1},
                  .all = nullptr,
                  .seen = {{0, 1, 2}}};
  drawing.bounds = drawing.body.bounds;
  const std::unique_ptr<TargetCanvas> canvas = MakeGlCanvas(std::move(context));
  canvas->Load(drawing, 1);
  canvas->Draw({0, 0, kSize, kSize});
  const std::span<const TargetCanvas::Pixel> pixels = canvas->Samples();
  int covered = 0;
  for (const TargetCanvas::Pixel& pixel : pixels) covered += pixel[1] == 65535 && pixel[3] == 65535;
  // Half the canvas, give or take the samples on the diagonal.
  if (covered < kSize * (kSize - 1) / 2 || covered > kSize * (kSize + 1) / 2) {
    throw std::runtime_error(description + ": a triangle is drawn wrongly");
  }
  return description;
}

}  // namespace windhover
