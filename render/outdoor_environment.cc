#include "render/outdoor_environment.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "render/outdoor_layers.h"
#include "render/procedural_noise.h"

namespace windhover {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

// A point of the ground: place, m, and the footprint there across and along the line of sight,
// whose direction is `sight`.
struct GroundPoint {
  Vector2f p;
  float across_m, along_m;
  Vector2f sight;
  float Footprint() const { return std::sqrt(across_m * along_m); }
  // How wide the footprint is in direction `n`.
  float Width(const Vector2f& n) const {
    const float along = along_m * n.dot(sight),
                across = across_m * (n.x() * sight.y() - n.y() * sight.x());
    return std::sqrt(along * along + across * across);
  }
};

// A layer of any kind.
class Thing {
 public:
  virtual ~Thing() = default;
  virtual bool CanBeIn(const SceneBounds& bounds) const = 0;
  virtual void Draw(const SceneRay& ray, Seen* seen) const = 0;
};
template <typename Layer>
class Placed final : public Thing {
 public:
  explicit Placed(const Layer& layer) : layer_(layer) {}
  bool CanBeIn(const SceneBounds& bounds) const override { return layer_.CanBeIn(bounds); }
  void Draw(const SceneRay& ray, Seen* seen) const override { layer_.Draw(ray, seen); }

 private:
  Layer layer_;
};

using Ground = std::function<Vector3f(const GroundPoint&)>;

// Layers are added in order, the farthest first.
class OutdoorEnvironment final : public Environment {
 public:
  OutdoorEnvironment(const EnvironmentConfig& config, float eye_height_m, Ground ground)
      : daylight_(config), eye_height_m_(eye_height_m), ground_(std::move(ground)) {}

  template <typename Layer>
  void Add(const Layer& layer) {
    layers_.push_back(std::make_unique<Placed<Layer>>(layer));
  }

  Vector3f Radiance(const Vector3f& d_W, float footprint_rad) const override {
    Vector3f light;
    FillRadiance({&d_W, 1}, footprint_rad, {&light, 1});
    return light;
  }

  void FillRadiance(std::span<const Vector3f> d_W, float footprint_rad,
                    std::span<Vector3f> light) const override {
    std::vector<SceneRay> rays;
    rays.reserve(d_W.size());
    for (const Vector3f& d : d_W) {
      const float level = std::max(std::sqrt(d.x() * d.x() + d.y() * d.y()), 1e-4f);
      rays.push_back({d, std::atan2(d.y(), d.x()), d.z() / level, footprint_rad, eye_height_m_,
                      &daylight_, daylight_.AirLight(d.head<2>() / level)});
    }
    const std::vector<const Thing*> in_view = ThingsIn(SceneBounds(rays));
    for (std::size_t i = 0; i < rays.size(); ++i) light[i] = Look(rays[i], in_view);
  }

  Vector3f AirLight(const Vector3f& d_W) const override {
    return daylight_.AirLight(d_W.head<2>() / std::max(d_W.head<2>().norm(), 1e-4f));
  }

 private:
  Vector3f GroundColour(const SceneRay& ray) const {
    const float distance = eye_height_m_ / -ray.slope;
    const Vector2f sight = ray.d_W.head<2>() / std::max(ray.d_W.head<2>().norm(), 1e-4f);
    const GroundPoint point{distance * sight, distance * ray.footprint_rad,
                            distance * distance / eye_height_m_ * ray.footprint_rad, sight};
    return ray.Lit(ground_(point), distance);
  }

  // The nearest first.
  std::vector<const Thing*> ThingsIn(const SceneBounds& bounds) const {
    std::vector<const Thing*> things;
    for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
      if ((*layer)->CanBeIn(bounds)) things.push_back(layer->get());
    }
    return things;
  }

  Vector3f Look(const SceneRay& ray, const std::vector<const Thing*>& things) const {
    Seen seen;
    for (const Thing* thing : things) {
      thing->Draw(ray, &seen);
      if (seen.IsEnough()) return seen.colour();
    }
    seen.Add(ray.d_W.z() < -1e-4f ? GroundColour(ray) : SkyRadiance(ray), 1);
    return seen.colour();
  }

  Daylight daylight_;
  float eye_height_m_;
  Ground ground_;
  std::vector<std::unique_ptr<const Thing>> layers_;
};

Vector3f Grass(const GroundPoint& g) {
  const float blades = FractalNoise(g.p.x() * 3, g.p.y() * 3, 6, g.Footprint() * 3, 31);
  const float patches =
      FractalNoise(g.p.x() * 0.08f, g.p.y() * 0.08f, 5, g.Footprint() * 0.08f, 32);
  return Vector3f(0.055f + 0.05f * patches, 0.115f + 0.03f * patches, 0.026f) *
         (0.55f + 0.9f * blades);
}

// A 400 m track (IAAF: straights of 84.39 m, bends of 36.5 m, eight lanes of 1.22 m) around a
// football field; the eye is above its centre.
Vector3f PlaygroundGround(const GroundPoint& g) {
  constexpr float kHalfStraight_m = 42.195f, kRadius_m = 36.5f, kLane_m = 1.22f;
  const float x = g.p.x(), y = g.p.y(), footprint = g.Footprint();
  const float wide_x = g.Width({1, 0}), wide_y = g.Width({0, 1});
  const float bend_x = std::max(std::abs(x) - kHalfStraight_m, 0.0f);
  const float from_bend = std::sqrt(bend_x * bend_x + y * y), outside = from_bend - kRadius_m;
  const float wide = g.Width(Vector2f(bend_x, y) / std::max(from_bend, 1.0f));
  Vector3f colour = Grass(g);
  colour *= 0.85f + 0.3f * StripeCoverage(x, 10.0f, 0.5f, wide_x);  // Mown in stripes.
  const float track = BandCoverage(outside, 0, 8 * kLane_m, wide);
  if (track > 0) {
    const float grain = FractalNoise(x * 2, y * 2, 4, footprint * 2, 33);
    Blend(Vector3f(0.36f, 0.075f, 0.05f) * (0.75f + 0.5f * grain), track, &colour);
  }
  const float lines = StripeCoverage(outside + 0.025f, kLane_m, 0.05f / kLane_m, wide) *
                      BandCoverage(outside, -0.05f, 8 * kLane_m + 0.05f, wide);
  Blend(Vector3f::Constant(0.75f), lines, &colour);
  // Football field of 100 × 64 m: touch and goal lines, halfway line, centre circle.
  const auto line = [](float v, float width) { return BandCoverage(v, -0.06f, 0.06f, width); };
  const float in_x = BandCoverage(x, -50, 50, wide_x), in_y = BandCoverage(y, -32, 32, wide_y);
  const float marks = std::max(
      std::max(line(std::abs(y) - 32, wide_y) * in_x, line(std::abs(x) - 50, wide_x) * in_y),
      std::max(line(x, wide_x) * in_y, line(g.p.norm() - 9.15f, g.along_m)));
  Blend(Vector3f::Constant(0.75f), marks, &colour);
  return colour;
}

Vector3f ForestGround(const GroundPoint& g) {
  const float fp = g.Footprint();
  const float litter = FractalNoise(g.p.x() * 1.5f, g.p.y() * 1.5f, 6, fp * 1.5f, 41);
  const float moss =
      SmoothStep(0.45f, 0.6f, FractalNoise(g.p.x() * 0.1f, g.p.y() * 0.1f, 4, fp * 0.1f, 42));
  Vector3f colour = Vector3f(0.11f, 0.075f, 0.042f) * (0.4f + 1.2f * litter);
  Blend(Vector3f(0.05f, 0.085f, 0.022f) * (0.4f + 1.2f * litter), moss, &colour);
  return colour;
}

// Streets every 60 m, both ways, among paving and lawns.
Vector3f StreetGround(const GroundPoint& g) {
  const float fp = g.Footprint();
  const Vector2f wide(g.Width({1, 0}), g.Width({0, 1}));
  const float grain = FractalNoise(g.p.x() * 2, g.p.y() * 2, 5, fp * 2, 51);
  const Vector3f asphalt = Vector3f(0.075f, 0.075f, 0.08f) * (0.6f + 0.8f * grain);
  Vector3f colour = Vector3f(0.27f, 0.26f, 0.245f) * (0.7f + 0.6f * grain);
  Blend(Vector3f::Constant(0.16f), 0.6f * StripeCoverage(g.p.x(), 2, 0.04f, wide.x()), &colour);
  const float lawn = StripeCoverage(g.p.x() + 8, 60, 0.27f, wide.x()) *
                     StripeCoverage(g.p.y() + 8, 60, 0.27f, wide.y());
  if (lawn > 0) Blend(Grass(g), lawn, &colour);
  for (const int axis : {0, 1}) {
    const float across = g.p[axis] - 30, along = g.p[1 - axis];
    Blend(asphalt, StripeCoverage(across + 5, 60, 10.f / 60, wide[axis]), &colour);
    const float dashes = StripeCoverage(across + 0.1f, 60, 0.2f / 60, wide[axis]) *
                         StripeCoverage(along, 9, 0.45f, wide[1 - axis]);
    Blend(Vector3f::Constant(0.7f), dashes, &colour);
  }
  return colour;
}

// Courts of 28 × 15 m (FIBA) in rows, every 36 m and 20 m, within a fence; the eye is above the
// middle of one.
Vector3f CourtGround(const GroundPoint& g) {
  if (g.p.squaredNorm() > 63 * 63) return Grass(g);
  const float fp = g.Footprint();
  const float x = g.p.x() - 36 * WholePart(g.p.x() / 36 + 0.5f);
  const float y = g.p.y() - 20 * WholePart(g.p.y() / 20 + 0.5f);
  const float grain = FractalNoise(g.p.x() * 2, g.p.y() * 2, 5, fp * 2, 61);
  const float wide_x = g.Width({1, 0}), wide_y = g.Width({0, 1});
  const auto in_x = [&](float v, float low, float high) {
    return BandCoverage(v, low, high, wide_x);
  };
  const auto in_y = [&](float half) { return BandCoverage(y, -half, half, wide_y); };
  const auto line = [](float v, float width) { return BandCoverage(v, -0.05f, 0.05f, width); };
  const auto circle = [&](float from_x, float radius) {  // About (from_x, 0) on either side.
    const Vector2f r(std::abs(x) - from_x, y);
    const Vector2f n = Vector2f(x < 0 ? -r.x() : r.x(), y) / std::max(r.norm(), 0.1f);
    return line(r.norm() - radius, g.Width(n));
  };
  Vector3f colour = Vector3f(0.05f, 0.17f, 0.09f);  // Green around, blue court, red key.
  Blend(Vector3f(0.045f, 0.10f, 0.24f), in_x(x, -14, 14) * in_y(7.5f), &colour);
  const float to_end = 14 - std::abs(x);
  Blend(Vector3f(0.36f, 0.07f, 0.05f), in_x(to_end, 0, 5.8f) * in_y(2.45f), &colour);
  colour *= 0.8f + 0.4f * grain;
  const auto along_x = [&](float half_y, float low, float high) {
    return line(std::abs(y) - half_y, wide_y) * in_x(to_end, low, high);
  };
  float marks = std::max(line(std::abs(x) - 14, wide_x) * in_y(7.5f), along_x(7.5f, 0, 14));
  marks = std::max(marks, std::max(line(x, wide_x) * in_y(7.5f), circle(0, 1.8f)));
  marks = std::max(marks, circle(12.425f, 6.75f) * in_x(to_end, 2.99f, 14));
  marks = std::max(marks, std::max(along_x(6.6f, 0, 2.99f), along_x(2.45f, 0, 5.8f)));
  marks = std::max(marks, line(to_end - 5.8f, wide_x) * in_y(2.45f));
  Blend(Vector3f::Constant(0.75f), marks, &colour);
  return colour;
}

const Vector3f kLeaf(0.06f, 0.115f, 0.03f), kDarkLeaf(0.035f, 0.075f, 0.025f);

std::unique_ptr<OutdoorEnvironment> MakePlayground(const EnvironmentConfig& config) {
  auto scene = std::make_unique<OutdoorEnvironment>(config, /*eye_height_m=*/4, PlaygroundGround);
  scene->Add(BuildingRow{260, 60, 12, 34, 0.35f, 71});
  scene->Add(TreeRow{170, 9, 9, 15, 0.15f, kDarkLeaf, 72});
  scene->Add(BuildingRow{150, 70, 9, 16, 0.6f, 73});
  scene->Add(TreeRow{120, 8, 5, 10, 0.2f, kLeaf, 74});
  for (const float azimuth : {-150.f, -95.f, -30.f, 8.f, 30.f, 85.f, 150.f}) {
    scene->Add(Mast{azimuth, 100, 18, 0.22f, 3.2f, 1.6f, {0.3f, 0.31f, 0.33f}});
  }
  scene->Add(Fence{95, 3, 3, {0.06f, 0.12f, 0.07f}});
  return scene;
}

std::unique_ptr<OutdoorEnvironment> MakeForest(const EnvironmentConfig& config) {
  auto scene = std::make_unique<OutdoorEnvironment>(config, /*eye_height_m=*/6, ForestGround);
  scene->Add(TreeRow{150, 6, 16, 24, 0.05f, kDarkLeaf, 81});
  scene->Add(TreeRow{95, 6, 13, 21, 0.15f, kLeaf * 0.8f, 82});
  scene->Add(TreeRow{65, 6, 10, 18, 0.25f, kDarkLeaf, 83});
  scene->Add(TreeRow{45, 7, 9, 16, 0.35f, kLeaf, 84});
  scene->Add(TreeRow{44, 3, 0.8f, 2.2f, 0, kLeaf * 0.9f, 85});  // Undergrowth.
  return scene;
}

std::unique_ptr<OutdoorEnvironment> MakeBuildings(const EnvironmentConfig& config) {
  auto scene = std::make_unique<OutdoorEnvironment>(config, /*eye_height_m=*/12, StreetGround);
  scene->Add(BuildingRow{420, 55, 30, 95, 0.15f, 91});
  scene->Add(BuildingRow{240, 42, 18, 55, 0.2f, 92});
  scene->Add(BuildingRow{140, 34, 12, 34, 0.3f, 93});
  scene->Add(TreeRow{110, 10, 6, 10, 0.25f, kLeaf, 94});
  for (int i = 0; i < 12; ++i) {
    scene->Add(
        Mast{static_cast<float>(i) * 30 - 168, 90, 9, 0.09f, 1.4f, 0.18f, {0.2f, 0.2f, 0.2f}});
  }
  return scene;
}

std::unique_ptr<OutdoorEnvironment> MakeBasketballCourt(const EnvironmentConfig& config) {
  auto scene = std::make_unique<OutdoorEnvironment>(config, /*eye_height_m=*/3, CourtGround);
  scene->Add(BuildingRow{130, 45, 12, 26, 0.35f, 95});
  scene->Add(TreeRow{80, 8, 6, 11, 0.2f, kLeaf, 96});
  scene->Add(Fence{62, 4, 3, {0.05f, 0.11f, 0.06f}});
  for (const float azimuth : {-130.f, -50.f, 9.f, 50.f, 130.f}) {
    scene->Add(Mast{azimuth, 58, 9, 0.11f, 1.6f, 0.4f, {0.25f, 0.26f, 0.28f}});
  }
  // Baskets of the eye's own court and of its neighbours, the farthest first.
  std::vector<Vector2f> baskets;
  for (const float x : {-49.f, -23.f, -13.f, 13.f, 23.f, 49.f}) {
    for (const float y : {-40.f, -20.f, 0.f, 20.f, 40.f}) {
      if (std::hypot(x, y) < 57) baskets.emplace_back(x, y);
    }
  }
  std::stable_sort(baskets.begin(), baskets.end(),
                   [](const Vector2f& p, const Vector2f& q) { return p.norm() > q.norm(); });
  for (const Vector2f& p : baskets) {
    scene->Add(Hoop{std::atan2(p.y(), p.x()) * 57.29578f, p.norm()});
  }
  return scene;
}

}  // namespace

std::unique_ptr<Environment> MakeOutdoorEnvironment(const EnvironmentConfig& config) {
  switch (config.type) {
    case EnvironmentType::kPlayground:
      return MakePlayground(config);
    case EnvironmentType::kForest:
      return MakeForest(config);
    case EnvironmentType::kBuildings:
      return MakeBuildings(config);
    case EnvironmentType::kBasketballCourt:
      return MakeBasketballCourt(config);
    default:
      throw std::logic_error("not a procedural environment");
  }
}

}  // namespace windhover
