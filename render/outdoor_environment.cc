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

// A point of the ground: place, m, and the footprint there across and along the line of sight.
struct GroundPoint {
  Vector2f p;
  float across_m, along_m;
  float Footprint() const { return std::sqrt(across_m * along_m); }
};

using Ground = std::function<Vector3f(const GroundPoint&)>;

// Layers are added in order, the farthest first.
class OutdoorEnvironment final : public Environment {
 public:
  OutdoorEnvironment(const EnvironmentConfig& config, float eye_height_m, Ground ground)
      : eye_height_m_(eye_height_m), ground_(std::move(ground)) {
    // The scene is turned by yaw_deg afterwards; the sun's azimuth is in W.
    sky_.sun_direction_W =
        DirectionFromAngles(config.sun_azimuth_deg - config.yaw_deg, config.sun_elevation_deg);
  }

  template <typename Layer>
  void Add(Layer layer) {
    layers_.push_back([layer](const SceneRay& ray, Seen* seen) { layer.Draw(ray, seen); });
  }
  Sky& sky() { return sky_; }

  Vector3f Radiance(const Vector3f& d_W, float footprint_rad) const override {
    const float level = std::sqrt(d_W.x() * d_W.x() + d_W.y() * d_W.y());
    const SceneRay ray{d_W, std::atan2(d_W.y(), d_W.x()), d_W.z() / std::max(level, 1e-4f),
                       footprint_rad, eye_height_m_};
    Seen seen;
    for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
      (*layer)(ray, &seen);
      if (seen.IsEnough()) return seen.colour();
    }
    seen.Add(d_W.z() < -1e-4f ? GroundColour(ray) : sky_.Radiance(ray), 1);
    return seen.colour();
  }

 private:
  Vector3f GroundColour(const SceneRay& ray) const {
    const float distance = eye_height_m_ / -ray.slope;
    const GroundPoint point{
        {distance * std::cos(ray.azimuth_rad), distance * std::sin(ray.azimuth_rad)},
        distance * ray.footprint_rad,
        distance * distance / eye_height_m_ * ray.footprint_rad};
    return Hazed(ground_(point), distance);
  }

  float eye_height_m_;
  Ground ground_;
  Sky sky_;
  std::vector<std::function<void(const SceneRay&, Seen*)>> layers_;
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
  const float bend_x = std::max(std::abs(x) - kHalfStraight_m, 0.0f);
  const float outside = std::sqrt(bend_x * bend_x + y * y) - kRadius_m;
  Vector3f colour = Grass(g);
  colour *= 0.85f + 0.3f * StripeCoverage(x, 10.0f, 0.5f, footprint);  // Mown in stripes.
  const float track = BandCoverage(outside, 0, 8 * kLane_m, footprint);
  const float grain = FractalNoise(x * 2, y * 2, 4, footprint * 2, 33);
  Blend(Vector3f(0.36f, 0.075f, 0.05f) * (0.75f + 0.5f * grain), track, &colour);
  const float lines = StripeCoverage(outside + 0.025f, kLane_m, 0.05f / kLane_m, footprint) *
                      BandCoverage(outside, -0.05f, 8 * kLane_m + 0.05f, footprint);
  Blend(Vector3f::Constant(0.75f), lines, &colour);
  // Football field of 100 × 64 m: touch and goal lines, halfway line, centre circle.
  const auto line = [&](float v) { return BandCoverage(v, -0.06f, 0.06f, footprint); };
  const float in_x = BandCoverage(x, -50, 50, footprint),
              in_y = BandCoverage(y, -32, 32, footprint);
  const float marks =
      std::max(std::max(line(std::abs(y) - 32) * in_x, line(std::abs(x) - 50) * in_y),
               std::max(line(x) * in_y, line(g.p.norm() - 9.15f)));
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
  const float grain = FractalNoise(g.p.x() * 2, g.p.y() * 2, 5, fp * 2, 51);
  const Vector3f asphalt = Vector3f(0.075f, 0.075f, 0.08f) * (0.6f + 0.8f * grain);
  Vector3f colour = Vector3f(0.27f, 0.26f, 0.245f) * (0.7f + 0.6f * grain);
  Blend(Vector3f::Constant(0.16f), 0.6f * StripeCoverage(g.p.x(), 2, 0.04f, fp), &colour);
  Blend(Grass(g),
        StripeCoverage(g.p.x() + 8, 60, 0.27f, fp) * StripeCoverage(g.p.y() + 8, 60, 0.27f, fp),
        &colour);
  for (const int axis : {0, 1}) {
    const float across = g.p[axis] - 30, along = g.p[1 - axis];
    Blend(asphalt, StripeCoverage(across + 5, 60, 10.f / 60, fp), &colour);
    const float dashes =
        StripeCoverage(across + 0.1f, 60, 0.2f / 60, fp) * StripeCoverage(along, 9, 0.45f, fp);
    Blend(Vector3f::Constant(0.7f), dashes, &colour);
  }
  return colour;
}

// Courts of 28 × 15 m (FIBA), side by side every 20 m; the eye is above the middle of one.
Vector3f CourtGround(const GroundPoint& g) {
  const float fp = g.Footprint(), x = g.p.x();
  const float row = WholePart(g.p.y() / 20 + 0.5f);
  const float y = g.p.y() - 20 * row;
  const float grain = FractalNoise(g.p.x() * 2, g.p.y() * 2, 5, fp * 2, 61);
  const auto in = [&](float v, float low, float high) { return BandCoverage(v, low, high, fp); };
  const auto line = [&](float v) { return BandCoverage(v, -0.05f, 0.05f, fp); };
  Vector3f colour = Vector3f(0.05f, 0.17f, 0.09f);  // Green around, blue court, red key.
  const float court = in(x, -14, 14) * in(y, -7.5f, 7.5f);
  Blend(Vector3f(0.045f, 0.10f, 0.24f), court, &colour);
  const float to_end = 14 - std::abs(x);
  Blend(Vector3f(0.36f, 0.07f, 0.05f), in(to_end, 0, 5.8f) * in(y, -2.45f, 2.45f), &colour);
  colour *= 0.8f + 0.4f * grain;
  const float from_hoop = std::sqrt((to_end - 1.575f) * (to_end - 1.575f) + y * y);
  float marks = std::max(line(std::abs(x) - 14) * in(y, -7.5f, 7.5f),
                         line(std::abs(y) - 7.5f) * in(x, -14, 14));
  marks = std::max(marks,
                   std::max(line(x) * in(y, -7.5f, 7.5f), line(std::sqrt(x * x + y * y) - 1.8f)));
  marks = std::max(marks, line(from_hoop - 6.75f) * in(to_end, 2.99f, 14));
  marks = std::max(marks, line(std::abs(y) - 6.6f) * in(to_end, 0, 2.99f));
  marks = std::max(marks, std::max(line(to_end - 5.8f) * in(y, -2.45f, 2.45f),
                                   line(std::abs(y) - 2.45f) * in(to_end, 0, 5.8f)));
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
  scene->sky().cloud_cover = 0.8f;
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
  scene->Add(BuildingRow{110, 45, 12, 26, 0.35f, 95});
  scene->Add(TreeRow{62, 7, 6, 11, 0.2f, kLeaf, 96});
  scene->Add(Fence{42, 4, 3, {0.05f, 0.11f, 0.06f}});
  for (const float azimuth : {-130.f, -50.f, 9.f, 50.f, 130.f}) {
    scene->Add(Mast{azimuth, 36, 8, 0.09f, 1.2f, 0.3f, {0.25f, 0.26f, 0.28f}});
  }
  // Both baskets of the eye's own court and those of its neighbours.
  for (const float azimuth : {0.f, 180.f}) {
    for (const float side : {-40.f, -20.f, 20.f, 40.f, 0.f}) {
      const float x = 13, angle = std::atan2(side, x) * 57.29578f;
      scene->Add(Hoop{azimuth + angle, std::sqrt(x * x + side * side)});
    }
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
