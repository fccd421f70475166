#include "render/target_canvas.h"

namespace windhover {

void TargetCanvas::ReadCover(std::vector<TargetLayer::Sample>* cover) {
  const std::span<const Pixel> samples = Samples();
  cover->resize(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) (*cover)[i] = SampleOf(samples[i][3]);
}

void TargetCanvas::AddPixels(std::array<std::uint32_t, 4>* sums, std::ptrdiff_t stride) {
  const int s = samples_per_px_;
  const Pixel* sample = Samples().data();
  for (int row = 0; row < shown_.height * s; ++row) {
    std::array<std::uint32_t, 4>* sum = sums + row / s * stride;
    for (int x = 0; x < shown_.width; ++x, ++sum) {
      for (int i = 0; i < s; ++i, ++sample) {
        if ((*sample)[3] == 0) continue;  // Most samples.
        for (std::size_t c = 0; c < 4; ++c) (*sum)[c] += (*sample)[c];
      }
    }
  }
}

}  // namespace windhover
