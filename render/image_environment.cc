#include "render/image_environment.h"

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "common/geometry/rotation.h"
#include "common/image/linear_image.h"

namespace windhover {
namespace {

using Eigen::Vector3f;

enum class Border { kWrap, kMirror };

int Fold(int i, int n, Border border) {
  if (border == Border::kWrap) return (i % n + n) % n;
  const int period = 2 * n, folded = (i % period + period) % period;
  return folded < n ? folded : period - 1 - folded;
}

LinearImage Halved(const LinearImage& image) {
  LinearImage half{.width_px = std::max(image.width_px / 2, 1),
                   .height_px = std::max(image.height_px / 2, 1),
                   .pixels = {},
                   .is_hdr = image.is_hdr};
  for (int y = 0; y < half.height_px; ++y) {
    for (int x = 0; x < half.width_px; ++x) {
      const int x1 = std::min(2 * x + 1, image.width_px - 1);
      const int y1 = std::min(2 * y + 1, image.height_px - 1);
      half.pixels.push_back(
          (image.At(2 * x, 2 * y) + image.At(x1, 2 * y) + image.At(2 * x, y1) + image.At(x1, y1)) /
          4);
    }
  }
  return half;
}

// An image in halving sizes, so that a wide footprint is one look-up.
class Pyramid {
 public:
  Pyramid(LinearImage image, Border border_x) : border_x_(border_x) {
    levels_.push_back(std::move(image));
    while (levels_.back().width_px > 1 && levels_.back().height_px > 1) {
      levels_.push_back(Halved(levels_.back()));
    }
  }

  const LinearImage& Full() const { return levels_.front(); }

  /// At (u, v) in 0..1 of width and height; `footprint_px` in pixels of the full image.
  Vector3f At(double u, double v, double footprint_px) const {
    std::size_t level = 0;
    while (footprint_px > 1.5 && level + 1 < levels_.size()) {
      footprint_px /= 2;
      ++level;
    }
    return Smooth(levels_[level], u * levels_[level].width_px - 0.5,
                  v * levels_[level].height_px - 0.5);
  }

 private:
  // Cubic B-spline: a magnified image stays free of the edges that linear interpolation shows.
  Vector3f Smooth(const LinearImage& image, double x, double y) const {
    const double x0 = std::floor(x), y0 = std::floor(y);
    const auto weights_x = Weights(static_cast<float>(x - x0));
    const auto weights_y = Weights(static_cast<float>(y - y0));
    Vector3f sum = Vector3f::Zero();
    for (int j = 0; j < 4; ++j) {
      const int row = Fold(static_cast<int>(y0) - 1 + j, image.height_px, Border::kMirror);
      Vector3f line = Vector3f::Zero();
      for (int i = 0; i < 4; ++i) {
        const int column = Fold(static_cast<int>(x0) - 1 + i, image.width_px, border_x_);
        line += weights_x[static_cast<std::size_t>(i)] * image.At(column, row);
      }
      sum += weights_y[static_cast<std::size_t>(j)] * line;
    }
    return sum;
  }

  static std::array<float, 4> Weights(float t) {
    const float s = 1 - t;
    return {s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * s * s + 3 * s * s * s) / 6,
            t * t * t / 6};
  }

  std::vector<LinearImage> levels_;
  Border border_x_;
};

void ToneMap(LinearImage* image) {
  double log_sum = 0;
  for (const Vector3f& p : image->pixels) log_sum += std::log(1e-6 + p.mean());
  const double log_mean = std::exp(log_sum / static_cast<double>(image->pixels.size()));
  const auto exposure = static_cast<float>(0.18 / log_mean);
  constexpr float kWhite = 4;
  for (Vector3f& p : image->pixels) {
    p *= exposure;
    const float light = p.maxCoeff();
    p *= (1 + light / (kWhite * kWhite)) / (1 + light);
  }
}

class Panorama final : public Environment {
 public:
  explicit Panorama(LinearImage image) : pyramid_(std::move(image), Border::kWrap) {}

  Vector3f Radiance(const Vector3f& d_W, float footprint_rad) const override {
    const double azimuth = std::atan2(d_W.y(), d_W.x());
    const double elevation = std::asin(std::clamp(d_W.z(), -1.0f, 1.0f));
    // Columns grow to the right, that is clockwise from above.
    return pyramid_.At(0.5 - azimuth / (2 * EIGEN_PI), 0.5 - elevation / EIGEN_PI,
                       footprint_rad * pyramid_.Full().width_px / (2 * EIGEN_PI));
  }

 private:
  Pyramid pyramid_;
};

class Photo final : public Environment {
 public:
  Photo(LinearImage image, double width_deg)
      : pyramid_(std::move(image), Border::kMirror), width_rad_(RadFromDeg(width_deg)) {}

  Vector3f Radiance(const Vector3f& d_W, float footprint_rad) const override {
    const LinearImage& full = pyramid_.Full();
    const double azimuth = std::atan2(d_W.y(), d_W.x());
    const double elevation = std::asin(std::clamp(d_W.z(), -1.0f, 1.0f));
    const double aspect = static_cast<double>(full.width_px) / full.height_px;
    return pyramid_.At(0.5 - azimuth / width_rad_, 0.5 - elevation / width_rad_ * aspect,
                       footprint_rad * full.width_px / width_rad_);
  }

 private:
  Pyramid pyramid_;
  double width_rad_;
};

}  // namespace

std::unique_ptr<Environment> MakePanoramaEnvironment(const InputFile& file) {
  LinearImage image = ReadLinearImage(file);
  const double aspect = static_cast<double>(image.width_px) / image.height_px;
  if (std::abs(aspect - 2) > 0.1) {
    throw ConfigError(
        fmt::format("{}: a panorama must be twice as wide as high (found '{}', {}x{} px)",
                    file.where, file.as_given, image.width_px, image.height_px));
  }
  if (image.is_hdr) ToneMap(&image);
  return std::make_unique<Panorama>(std::move(image));
}

std::unique_ptr<Environment> MakePhotoEnvironment(const InputFile& file, double width_deg) {
  LinearImage image = ReadLinearImage(file);
  if (image.is_hdr) ToneMap(&image);
  return std::make_unique<Photo>(std::move(image), width_deg);
}

}  // namespace windhover
