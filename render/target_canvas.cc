#include "render/target_canvas.h"

namespace windhover {

void TargetCanvas::ReadCoverage(std::vector<std::uint16_t>* coverage) {
  const std::span<const Pixel> samples = Samples();
  coverage->resize(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) (*coverage)[i] = samples[i][3];
}

void TargetCanvas::SumPixels(std::vector<std::array<std::uint32_t, 4>>* sums) {
  const std::span<const Pixel> samples = Samples();
  const auto width = static_cast<std::size_t>(shown_.width);
  const auto s = static_cast<std::size_t>(samples_per_px_);
  sums->assign(width * static_cast<std::size_t>(shown_.height), {});
  const Pixel* sample = samples.data();
  for (std::size_t row = 0; row < static_cast<std::size_t>(shown_.height) * s; ++row) {
    for (std::size_t x = 0; x < width; ++x) {
      std::array<std::uint32_t, 4>& sum = (*sums)[row / s * width + x];
      for (std::size_t i = 0; i < s; ++i, ++sample) {
        if ((*sample)[3] == 0) continue;  // Most samples.
        for (std::size_t c = 0; c < 4; ++c) sum[c] += (*sample)[c];
      }
    }
  }
}

}  // namespace windhover
