#include "render/layer_sum.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include <emmintrin.h>

namespace windhover {
namespace {

using Sum = std::array<std::uint32_t, 4>;

__m128i Load(const Sum& sum) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(sum.data()));
}

void Store(__m128i value, Sum* sum) {
  _mm_storeu_si128(reinterpret_cast<__m128i*>(sum->data()), value);
}

// Adds what is between four corners to each of `sums`.
void AddBoxes(std::span<const Sum> above, std::span<const Sum> below, Sum* sums) {
  __m128i left = _mm_sub_epi32(Load(below[0]), Load(above[0]));
  for (std::size_t x = 1; x < above.size(); ++x, ++sums) {
    const __m128i right = _mm_sub_epi32(Load(below[x]), Load(above[x]));
    Store(_mm_add_epi32(Load(*sums), _mm_sub_epi32(right, left)), sums);
    left = right;
  }
}

}  // namespace

TargetLayer::Sample TargetLayer::SampleAt(double x_px, double y_px) const {
  const auto column = static_cast<std::int64_t>(std::floor((x_px + 0.5 - roi.x0) * samples_per_px));
  const auto row = static_cast<std::int64_t>(std::floor((y_px + 0.5 - roi.y0) * samples_per_px));
  const std::int64_t columns = std::int64_t{roi.width} * samples_per_px;
  const std::int64_t rows = std::int64_t{roi.height} * samples_per_px;
  if (column < 0 || row < 0 || column >= columns || row >= rows) return Sample::kEmpty;
  return samples[static_cast<std::size_t>(row * columns + column)];
}

void BoxSums::Set(std::span<const TargetCanvas::Pixel> samples, const PixelRect& shown,
                  int samples_per_px) {
  shown_ = shown;
  columns_ = shown.width * samples_per_px;
  rows_ = shown.height * samples_per_px;
  const std::ptrdiff_t stride = columns_ + 1;
  sums_.resize(static_cast<std::size_t>(stride) * static_cast<std::size_t>(rows_ + 1));
  std::fill_n(sums_.begin(), stride, Sum{});
  const TargetCanvas::Pixel* sample = samples.data();
  for (int y = 0; y < rows_; ++y) {
    const Sum* above = sums_.data() + y * stride;
    Sum* out = sums_.data() + (y + 1) * stride;
    *out++ = Sum{};
    __m128i row = _mm_setzero_si128();
    for (int x = 0; x < columns_; ++x, ++sample) {
      const __m128i light = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(sample->data()));
      row = _mm_add_epi32(row, _mm_unpacklo_epi16(light, _mm_setzero_si128()));
      Store(_mm_add_epi32(row, Load(*++above)), out++);
    }
  }
}

LayerSum::LayerSum(const PixelRect& roi, int samples_per_px) {
  layer_.roi = roi;
  layer_.samples_per_px = samples_per_px;
  const auto pixels = static_cast<std::size_t>(roi.width) * static_cast<std::size_t>(roi.height);
  sums_.resize(pixels);
  layer_.samples.resize(pixels * static_cast<std::size_t>(samples_per_px * samples_per_px));
}

// Adds the sums up to the samples `from`, from + step, … to `corners`; nothing is to the left of
// the first sample, nor anything more to the right of the last.
void BoxSums::AddCorners(int row, int from, int step, std::span<Sum> corners) const {
  const Sum* sums = sums_.data() + static_cast<std::ptrdiff_t>(row) * (columns_ + 1);
  const int n = static_cast<int>(corners.size());
  const int first = from >= 0 ? 0 : std::min((-from + step - 1) / step, n);
  const int end = from > columns_ ? first : std::clamp((columns_ - from) / step + 1, first, n);
  Sum* corner = corners.data() + first;
  const Sum* sum = sums + from + std::ptrdiff_t{first} * step;
  for (int x = first; x < end; ++x, ++corner, sum += step) {
    Store(_mm_add_epi32(Load(*corner), Load(*sum)), corner);
  }
  const __m128i all = Load(sums[columns_]);
  for (int x = end; x < n; ++x, ++corner) Store(_mm_add_epi32(Load(*corner), all), corner);
}

// Neighbouring boxes share their corners: those of all shifts are summed up before differences are
// taken, modulo 2^32.
void LayerSum::Add(const BoxSums& boxes, std::span<const SampleShift> shifts) {
  const int s = layer_.samples_per_px;
  const PixelRect& shown = boxes.shown_;
  int x_first = layer_.roi.width, y_first = layer_.roi.height, x_end = 0, y_end = 0;
  // Places of the region's first sample among those of the boxes.
  const auto x0 = [&](const SampleShift& k) { return (layer_.roi.x0 - shown.x0) * s - k.columns; };
  const auto y0 = [&](const SampleShift& k) { return (layer_.roi.y0 - shown.y0) * s - k.rows; };
  for (const SampleShift& shift : shifts) {
    x_first = std::min(x_first, std::max(-x0(shift) / s, 0));
    y_first = std::min(y_first, std::max(-y0(shift) / s, 0));
    x_end = std::max(x_end, std::min(layer_.roi.width, (boxes.columns_ - x0(shift) + s - 1) / s));
    y_end = std::max(y_end, std::min(layer_.roi.height, (boxes.rows_ - y0(shift) + s - 1) / s));
  }
  if (x_end <= x_first) return;
  const auto n = static_cast<std::size_t>(x_end - x_first);
  std::vector<Sum> above(n + 1), below(n + 1);
  for (int y = y_first; y <= y_end; ++y) {
    std::fill(below.begin(), below.end(), Sum{});
    for (const SampleShift& shift : shifts) {
      const int row = std::clamp(y0(shift) + y * s, 0, boxes.rows_);
      boxes.AddCorners(row, x0(shift) + x_first * s, s, below);
    }
    if (y > y_first)
      AddBoxes(above, below, PixelsAt(layer_.roi.x0 + x_first, layer_.roi.y0 + y - 1));
    std::swap(above, below);
  }
}

void LayerSum::SetCover(const PixelRect& shown, std::span<const TargetLayer::Sample> cover,
                        const SampleShift& shift) {
  const int s = layer_.samples_per_px;
  const int columns = layer_.roi.width * s, rows = layer_.roi.height * s;
  const int x0 = (shown.x0 - layer_.roi.x0) * s + shift.columns;
  const int y0 = (shown.y0 - layer_.roi.y0) * s + shift.rows;
  const int from = std::max(-x0, 0), to = std::min(shown.width * s, columns - x0);
  for (int y = std::max(-y0, 0); y < std::min(shown.height * s, rows - y0) && from < to; ++y) {
    const TargetLayer::Sample* in = cover.data() + std::ptrdiff_t{y} * shown.width * s;
    std::copy(in + from, in + to,
              layer_.samples.data() + std::ptrdiff_t{y0 + y} * columns + x0 + from);
  }
}

TargetLayer LayerSum::Mean(std::size_t exposures) && {
  const int samples = layer_.samples_per_px * layer_.samples_per_px;
  const __m128 share =
      _mm_set1_ps(1 / (static_cast<float>(exposures) * static_cast<float>(samples)));
  layer_.pixels.resize(sums_.size());
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const __m128i mean = _mm_cvtps_epi32(_mm_mul_ps(_mm_cvtepi32_ps(Load(sums_[i])), share));
    // SSE2 packs signed values only.
    const __m128i packed = _mm_packs_epi32(_mm_sub_epi32(mean, _mm_set1_epi32(32768)), mean);
    _mm_storel_epi64(reinterpret_cast<__m128i*>(layer_.pixels[i].data()),
                     _mm_xor_si128(packed, _mm_set1_epi16(-32768)));
  }
  return std::move(layer_);
}

}  // namespace windhover
