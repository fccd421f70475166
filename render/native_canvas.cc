#include <algorithm>
#include <cmath>
#include <cstring>

#include <emmintrin.h>

#include "render/raster_mesh.h"
#include "render/target_canvas.h"

namespace windhover {
namespace {

using Float4 [[gnu::vector_size(16)]] = float;

constexpr float kWhite = 65535;

Float4 LightOf(const std::array<float, 4>& from) {
  Float4 value;
  std::memcpy(&value, from.data(), sizeof value);
  return value;
}

TargetCanvas::Pixel PixelFrom(Float4 light) {
  const __m128i rounded = _mm_cvtps_epi32(reinterpret_cast<__m128>(light * kWhite));
  // SSE2 packs signed values only.
  const __m128i packed = _mm_packs_epi32(_mm_sub_epi32(rounded, _mm_set1_epi32(32768)), rounded);
  TargetCanvas::Pixel pixel;
  _mm_storel_epi64(reinterpret_cast<__m128i*>(pixel.data()),
                   _mm_xor_si128(packed, _mm_set1_epi16(-32768)));
  return pixel;
}

// Light over a triangle.
struct Shade {
  Float4 at_a, per_column, per_row, lowest, highest;
  float x, y;  // Of corner a, in samples from the image's first.
};

// Along row `y` of samples, columns from `x0` on.
struct ShadeRow {
  ShadeRow(const Shade& shade, float x0, float y)
      : first(shade.at_a + (y - shade.y) * shade.per_row + (x0 - shade.x) * shade.per_column),
        per_column(shade.per_column),
        lowest(shade.lowest),
        highest(shade.highest) {}

  Float4 At(float column) const {
    Float4 light = first + column * per_column;
    light = light < lowest ? lowest : light;  // A sliver's slopes overshoot.
    return light > highest ? highest : light;
  }

  Float4 first, per_column, lowest, highest;
};

Shade MakeShade(const std::array<RasterVertex, 3>& v, const std::array<Float4, 3>& light) {
  const auto per_area =
      static_cast<float>(kSampleSteps / static_cast<double>(FacingArea(v[0], v[1], v[2])));
  const float xb = static_cast<float>(v[1].x - v[0].x) * per_area;
  const float yb = static_cast<float>(v[1].y - v[0].y) * per_area;
  const float xc = static_cast<float>(v[2].x - v[0].x) * per_area;
  const float yc = static_cast<float>(v[2].y - v[0].y) * per_area;
  const Float4 to_b = light[1] - light[0], to_c = light[2] - light[0];
  const Float4 low = light[0] < light[1] ? light[0] : light[1];
  const Float4 high = light[0] < light[1] ? light[1] : light[0];
  constexpr float kPerStep = 1.0f / kSampleSteps;
  return {light[0],
          to_c * yb - to_b * yc,
          to_b * xc - to_c * xb,
          low < light[2] ? low : light[2],
          high < light[2] ? light[2] : high,
          static_cast<float>(v[0].x) * kPerStep - 0.5f,
          static_cast<float>(v[0].y) * kPerStep - 0.5f};
}

// Keeps, of each sample, the nearest triangle's index and its nearness, and computes light only
// where it is seen, run by run of samples of one triangle.
class NativeCanvas final : public TargetCanvas {
 public:
  explicit NativeCanvas(InstructionSet isa) : isa_(isa) {}

  TileLimits Limits() const override { return {2048, 2048, 65536}; }
  void Load(const TargetDrawing& drawing, int samples_per_px) override;
  void Draw(const PixelRect& shown) override;
  std::span<const Pixel> Samples() override;
  void ReadCover(std::vector<TargetLayer::Sample>* cover) override;
  void AddPixels(std::array<std::uint32_t, 4>* sums, std::ptrdiff_t stride) override;

 private:
  void ClearTranslucent();
  const Shade& ShadeOf(std::uint32_t index);
  template <typename Body>
  void ForRuns(int row, Body&& body);
  void SumBody(int row, Float4* sums);
  void SumTranslucent(int row, Float4* sums);
  std::ptrdiff_t Start(int row) const { return std::ptrdiff_t{row} * tile_.stride; }
  Float4 LightAt(std::uint32_t index, int column, int row) {
    return ShadeRow(ShadeOf(index), static_cast<float>(tile_.x0),
                    static_cast<float>(tile_.y0 + row))
        .At(static_cast<float>(column));
  }
  // Of a sample's column, without a division: exact below 2^13.
  int PixelOf(int column) const { return column * per_sample_ >> 16; }

  InstructionSet isa_;
  int per_sample_ = 65536;
  const TargetDrawing* drawing_ = nullptr;
  RasterMesh body_, discs_;
  std::vector<std::array<float, 4>> disc_light_;
  std::vector<std::uint32_t> shade_of_;  // One a triangle: place in shades_ plus 1, or 0.
  std::vector<Shade> shades_;

  SampleTile tile_;
  std::vector<float> nearness_;
  std::vector<std::uint32_t> nearest_;
  std::vector<std::array<float, 4>> translucent_;
  std::vector<int> first_, last_;
  std::vector<Float4> sums_;
  std::vector<Pixel> samples_;
};

void NativeCanvas::Load(const TargetDrawing& drawing, int samples_per_px) {
  drawing_ = &drawing;
  samples_per_px_ = samples_per_px;
  per_sample_ = (65536 + samples_per_px - 1) / samples_per_px;
  const Faces faces = drawing.target->model->IsWatertight() ? Faces::kFront : Faces::kBoth;
  body_.Set(drawing.body, faces, drawing.bounds, samples_per_px);
  discs_.Set(drawing.discs, Faces::kFront, drawing.bounds, samples_per_px);
  disc_light_.resize(discs_.Vertices().size());
  for (std::size_t i = 0; i < disc_light_.size(); ++i) {
    const float alpha = drawing.disc_alphas[i];
    const Eigen::Vector3f light = (drawing.target->disc_light[i] * alpha).cwiseMin(1);
    disc_light_[i] = {light.x(), light.y(), light.z(), alpha};
  }
  shade_of_.assign(body_.Triangles().size(), 0);
  shades_.clear();
}

void NativeCanvas::Draw(const PixelRect& shown) {
  shown_ = shown;
  const int s = samples_per_px_;
  tile_ = {.x0 = shown.x0 * s,
           .y0 = shown.y0 * s,
           .width = shown.width * s,
           .height = shown.height * s,
           .stride = (shown.width * s + 2 * SampleTile::kPadding - 1) & -SampleTile::kPadding};
  const auto size = static_cast<std::size_t>(Start(tile_.height));
  nearness_.assign(size, 0);
  nearest_.assign(size, 0);
  tile_.nearness = nearness_.data();
  tile_.nearest = nearest_.data();
  DrawOpaque(isa_, body_.Vertices(), body_.Triangles(), tile_);
  ClearTranslucent();
  DrawTranslucent(isa_, discs_.Vertices(), disc_light_, discs_.Triangles(), tile_,
                  {translucent_.data(), first_.data(), last_.data()});
}

// Only where discs may be.
void NativeCanvas::ClearTranslucent() {
  const auto rows = static_cast<std::size_t>(tile_.height);
  first_.assign(rows, tile_.width);
  last_.assign(rows, 0);
  if (translucent_.size() < nearness_.size()) translucent_.resize(nearness_.size());
  const ImageBounds& discs = drawing_->discs.bounds;
  const auto sample_at = [this](double px, int first, int limit) {
    const double sample = std::floor((px + 0.5) * samples_per_px_) - first;
    return static_cast<int>(std::clamp(sample, -1.0, limit + 1.0));
  };
  const int from = std::max(sample_at(discs.x_min, tile_.x0, tile_.width) - 1, 0);
  const int to = std::min(sample_at(discs.x_max, tile_.x0, tile_.width) + 2, tile_.width);
  const int first_row = std::max(sample_at(discs.y_min, tile_.y0, tile_.height) - 1, 0);
  const int last_row =
      std::min(sample_at(discs.y_max, tile_.y0, tile_.height) + 1, tile_.height - 1);
  for (int row = first_row; row <= last_row && from < to; ++row) {
    std::fill_n(translucent_.begin() + Start(row) + from, to - from, std::array<float, 4>{});
  }
}

const Shade& NativeCanvas::ShadeOf(std::uint32_t index) {
  std::uint32_t& place = shade_of_[index - 1];
  if (place == 0) {
    std::array<RasterVertex, 3> corners;
    std::array<Float4, 3> light;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t i = body_.Triangles()[index - 1].corners[k];
      corners[k] = body_.Vertices()[i];
      const Eigen::Vector3f clipped = drawing_->target->body_light[i].cwiseMin(1);
      light[k] = Float4{clipped.x(), clipped.y(), clipped.z(), 1};
    }
    shades_.push_back(MakeShade(corners, light));
    place = static_cast<std::uint32_t>(shades_.size());
  }
  return shades_[place - 1];
}

// Calls body(shade, first, last) for each run [first, last) of samples that show one triangle.
template <typename Body>
void NativeCanvas::ForRuns(int row, Body&& body) {
  std::uint32_t* index = nearest_.data() + Start(row);
  const std::uint32_t beyond = index[tile_.width];
  for (int i = 0; i < tile_.width;) {
    const std::uint32_t here = index[i];
    const int first = i++;
    index[tile_.width] = ~here;  // So that no run goes on.
    while (index[i] == here) ++i;
    if (here != 0) body(ShadeOf(here), first, i);
  }
  index[tile_.width] = beyond;
}

void NativeCanvas::SumBody(int row, Float4* sums) {
  const int s = samples_per_px_;
  ForRuns(row, [&](const Shade& shade, int first, int last) {
    const ShadeRow light(shade, static_cast<float>(tile_.x0), static_cast<float>(tile_.y0 + row));
    for (int pixel = PixelOf(first); first < last; ++pixel) {
      const int end = std::min(last, (pixel + 1) * s);
      const float middle = static_cast<float>(first + end - 1) * 0.5f;
      sums[pixel] += static_cast<float>(end - first) * light.At(middle);
      first = end;
    }
  });
}

// What is over the body takes its share of the body's light away.
void NativeCanvas::SumTranslucent(int row, Float4* sums) {
  const auto at = static_cast<std::size_t>(row);
  for (int i = first_[at]; i < last_[at]; ++i) {
    const Float4 over = LightOf(translucent_[static_cast<std::size_t>(Start(row) + i)]);
    if (over[3] == 0) continue;
    Float4& sum = sums[PixelOf(i)];
    sum += over;
    const std::uint32_t index = nearest_[static_cast<std::size_t>(Start(row) + i)];
    if (index != 0) sum -= over[3] * LightAt(index, i, row);
  }
}

void NativeCanvas::AddPixels(std::array<std::uint32_t, 4>* sums, std::ptrdiff_t stride) {
  const auto width = static_cast<std::size_t>(shown_.width);
  for (int y = 0; y < shown_.height; ++y) {
    sums_.assign(width, Float4{});
    for (int i = 0; i < samples_per_px_; ++i) {
      SumBody(y * samples_per_px_ + i, sums_.data());
      SumTranslucent(y * samples_per_px_ + i, sums_.data());
    }
    std::array<std::uint32_t, 4>* out = sums + y * stride;
    for (std::size_t x = 0; x < width; ++x) {
      const __m128i sum = _mm_cvtps_epi32(reinterpret_cast<__m128>(sums_[x] * kWhite));
      auto* place = reinterpret_cast<__m128i*>(out[x].data());
      _mm_storeu_si128(place, _mm_add_epi32(_mm_loadu_si128(place), sum));
    }
  }
}

std::span<const TargetCanvas::Pixel> NativeCanvas::Samples() {
  const auto width = static_cast<std::size_t>(tile_.width);
  samples_.assign(width * static_cast<std::size_t>(tile_.height), Pixel{});
  for (int row = 0; row < tile_.height; ++row) {
    Pixel* pixels = samples_.data() + static_cast<std::size_t>(row) * width;
    ForRuns(row, [&](const Shade& shade, int first, int last) {
      const ShadeRow light(shade, static_cast<float>(tile_.x0), static_cast<float>(tile_.y0 + row));
      for (int i = first; i < last; ++i) pixels[i] = PixelFrom(light.At(static_cast<float>(i)));
    });
    const auto at = static_cast<std::size_t>(row);
    for (int i = first_[at]; i < last_[at]; ++i) {
      Float4 over = LightOf(translucent_[static_cast<std::size_t>(Start(row) + i)]);
      const std::uint32_t index = nearest_[static_cast<std::size_t>(Start(row) + i)];
      if (index != 0) over += (1 - over[3]) * LightAt(index, i, row);
      pixels[i] = PixelFrom(over);
    }
  }
  return samples_;
}

void NativeCanvas::ReadCover(std::vector<TargetLayer::Sample>* cover) {
  using Sample = TargetLayer::Sample;
  const auto width = static_cast<std::size_t>(tile_.width);
  cover->resize(width * static_cast<std::size_t>(tile_.height));
  for (int row = 0; row < tile_.height; ++row) {
    const std::uint32_t* index = nearest_.data() + Start(row);
    Sample* out = cover->data() + static_cast<std::size_t>(row) * width;
    for (int i = 0; i < tile_.width; ++i) out[i] = index[i] != 0 ? Sample::kOpaque : Sample::kEmpty;
    const auto at = static_cast<std::size_t>(row);
    for (int i = first_[at]; i < last_[at]; ++i) {
      if (index[i] != 0) continue;
      const float over = translucent_[static_cast<std::size_t>(Start(row) + i)][3];
      out[i] = SampleOf(static_cast<std::uint16_t>(over * kWhite + 0.5f));
    }
  }
}

}  // namespace

std::unique_ptr<TargetCanvas> MakeNativeCanvas(InstructionSet isa) {
  return std::make_unique<NativeCanvas>(isa);
}

}  // namespace windhover
