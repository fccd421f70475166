#include "render/self_test.h"

#include <stdexcept>

#include "render/target_canvas.h"

namespace windhover {

std::string RunGlSelfTest() {
  std::unique_ptr<GlContext> context = MakeOsMesaContext();
  context->MakeCurrent();
  const std::string description = DescribeGl(*context);
  TargetCanvas canvas(std::move(context));
  constexpr int kSize = 64;
  canvas.Begin(kSize, kSize);
  // The half of the canvas below its falling diagonal.
  canvas.Draw(TargetCanvas::Surface::kOpen,
              {{-1, -1, 0, 0, 1, 0, 1}, {-1, 1, 0, 0, 1, 0, 1}, {1, 1, 0, 0, 1, 0, 1}},
              {{0, 1, 2}});
  std::vector<TargetCanvas::Pixel> pixels;
  canvas.Read(&pixels);
  int covered = 0;
  for (const TargetCanvas::Pixel& pixel : pixels) covered += pixel[1] == 65535 && pixel[3] == 65535;
  // Half the canvas, give or take the samples on the diagonal.
  if (covered < kSize * (kSize - 1) / 2 || covered > kSize * (kSize + 1) / 2) {
    throw std::runtime_error(description + ": a triangle is drawn wrongly");
  }
  return description;
}

}  // namespace windhover
