#include "render/outdoor_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "render/procedural_noise.h"

namespace windhover {
namespace {

using Eigen::Vector3f;

constexpr float kPi = static_cast<float>(EIGEN_PI);

// A position along a ring: number of the cell, place in it (0..1) and cells around.
struct RingCell {
  int count;
  int index;
  float place;
};

RingCell CellOf(const SceneRay& ray, float distance_m, float spacing_m) {
  const int count = std::max(3, static_cast<int>(std::lround(2 * kPi * distance_m / spacing_m)));
  const float t = (ray.azimuth_rad / (2 * kPi) + 0.5f) * static_cast<float>(count);
  const float whole = WholePart(t);
  return {count, static_cast<int>(whole), t - whole};
}

// Of a number at most n outside [0, n).
int Wrapped(int i, int n) { return i < 0 ? i + n : i >= n ? i - n : i; }

// From -pi to pi.
float Folded(float angle_rad) {
  return angle_rad - 2 * kPi * WholePart(angle_rad / (2 * kPi) + 0.5f);
}

// Offset to the right of `azimuth_deg`, in metres at the distance.
float SidewaysOf(const SceneRay& ray, float azimuth_deg, float distance_m) {
  return Folded(azimuth_deg * kPi / 180 - ray.azimuth_rad) * distance_m;
}

// Where the sun shines from on what a ray meets: its part to the left and ahead, 0 without sun.
struct SunSide {
  explicit SunSide(const SceneRay& ray) {
    const Vector3f& sun = ray.daylight->sun_direction;
    const float level = std::max(ray.d_W.head<2>().norm(), 1e-4f);
    left = ray.daylight->sun_share * (ray.d_W.x() * sun.y() - ray.d_W.y() * sun.x()) / level;
    ahead = ray.daylight->sun_share * (ray.d_W.x() * sun.x() + ray.d_W.y() * sun.y()) / level;
  }
  float left, ahead;
};

// The leaves of a tree.
struct Crown {
  float middle_z, radius_x, radius_z;
};

void AddCrown(const TreeRow& row, int index, const SceneRay& ray, const Crown& crown, float x,
              float z, Seen* seen) {
  const float footprint = ray.footprint_rad * row.distance_m;
  const float u = x / crown.radius_x, v = (z - crown.middle_z) / crown.radius_z;
  const float r = std::sqrt(u * u + v * v);
  if (r > 1.35f) return;
  // Boughs give the outline and the large shadows, leaves the grain.
  constexpr float kBough_m = 1.6f, kLeaf_m = 0.22f;
  const auto own = row.seed + 17u * static_cast<unsigned>(index);
  const float boughs = FractalNoise(x / kBough_m, z / kBough_m, 5, footprint / kBough_m, own);
  const float soft = std::max(footprint / crown.radius_x, 0.01f);
  const float rough_edge = 1.05f - r + (boughs - 0.5f) * 0.9f;
  if (rough_edge + 0.5f * 0.35f <= -soft) return;  // Whatever its leaves are.
  const float leaves =
      FractalNoise(x / kLeaf_m, z / kLeaf_m, 3, footprint / kLeaf_m, own + 5) - 0.5f;
  const float coverage = SmoothStep(-soft, soft, rough_edge + leaves * 0.35f);
  if (coverage <= 0) return;
  const float relief = std::max(boughs + 0.9f * leaves - 0.1f, 0.0f);
  const SunSide sun(ray);
  const float light =
      (0.5f + 0.35f * v + 0.3f * sun.left * u - 0.12f * sun.ahead) * relief * relief * 4.5f + 0.05f;
  const float tint = 0.8f + 0.4f * CellHash(index, 3, row.seed);
  const Vector3f leaf = row.leaf_colour.cwiseProduct(Vector3f(tint, 1, 2 - tint)) * light * 2;
  seen->Add(ray.Lit(leaf, row.distance_m), coverage);
}

void DrawTree(const TreeRow& row, int index, const SceneRay& ray, float x, float z, Seen* seen) {
  const float height =
      row.min_height_m + (row.max_height_m - row.min_height_m) * CellHash(index, 1, row.seed);
  const float bottom = height * row.trunk_share;
  const float radius_z = (height - bottom) / 2;
  const float radius_x = radius_z * (0.55f + 0.35f * CellHash(index, 2, row.seed));
  AddCrown(row, index, ray, {bottom + radius_z, radius_x, radius_z}, x, z, seen);
  if (seen->IsEnough()) return;
  const float trunk = height * 0.018f;
  const float footprint = ray.footprint_rad * row.distance_m;
  const float bark =
      BandCoverage(x, -trunk, trunk, footprint) * BandCoverage(z, 0, height * 0.7f, footprint);
  if (bark <= 0) return;
  seen->Add(ray.Lit(Vector3f(0.055f, 0.042f, 0.032f) * (1.1f + x / trunk * 0.4f), row.distance_m),
            bark);
}

Vector3f WallColour(int index, std::uint32_t seed) {
  const Vector3f palette[] = {{0.42f, 0.38f, 0.32f}, {0.33f, 0.16f, 0.11f}, {0.50f, 0.49f, 0.46f},
                              {0.36f, 0.30f, 0.22f}, {0.24f, 0.27f, 0.31f}, {0.55f, 0.50f, 0.40f}};
  return palette[static_cast<int>(CellHash(index, 5, seed) * 6) % 6];
}

// Facade at x metres along and z metres up: floors of windows in a wall.
Vector3f Facade(int index, float x, float z, float footprint, std::uint32_t seed) {
  const float bay = 2.2f + 1.6f * CellHash(index, 6, seed), floor = 3.1f;
  const float open_x = StripeCoverage(x - 0.2f * bay, bay, 0.58f, footprint);
  const float open_z = StripeCoverage(z - 0.9f, floor, 0.52f, footprint);
  const float glass = open_x * open_z;
  const auto pane_x = static_cast<int>(WholePart(x / bay));
  const auto pane_z = static_cast<int>(WholePart(z / floor));
  const float sharp = 1 - SmoothStep(0.3f * bay, bay, footprint);
  const float pane = 0.5f + sharp * (CellHash(pane_x + 977 * index, pane_z, seed + 7) - 0.5f);
  const float grain = FractalNoise(x * 0.5f, z * 0.5f, 4, footprint * 0.5f, seed + 8);
  Vector3f colour = WallColour(index, seed) * (0.55f + 0.5f * grain);
  // Ledges between the floors.
  Blend(colour * 1.35f, 0.8f * StripeCoverage(z, floor, 0.06f, footprint), &colour);
  Blend(Vector3f(0.07f, 0.10f, 0.14f) * (0.4f + 1.8f * pane), glass, &colour);
  return colour;
}

}  // namespace

SceneBounds::SceneBounds(std::span<const SceneRay> rays)
    : lowest_(rays.front()), highest_(rays.front()), middle_azimuth_rad_(rays.front().azimuth_rad) {
  float left = 0, right = 0;
  for (const SceneRay& ray : rays) {
    if (ray.slope < lowest_.slope) lowest_ = ray;
    if (ray.slope > highest_.slope) highest_ = ray;
    const float turn = Folded(ray.azimuth_rad - middle_azimuth_rad_);
    left = std::max(left, turn);
    right = std::min(right, turn);
  }
  middle_azimuth_rad_ += (left + right) / 2;
  half_width_rad_ = (left - right) / 2;
}

// Heights go up with slopes, also as rounded.
bool SceneBounds::Reaches(float distance_m, float low_m, float high_m) const {
  return highest_.HeightAt(distance_m) >= low_m && lowest_.HeightAt(distance_m) <= high_m;
}

bool SceneBounds::LooksTo(float azimuth_deg, float distance_m, float reach_m) const {
  constexpr float kRounding_rad = 1e-4f;
  const float turn = Folded(azimuth_deg * kPi / 180 - middle_azimuth_rad_);
  return std::abs(turn) <= half_width_rad_ + reach_m / distance_m + kRounding_rad;
}

Vector3f SkyRadiance(const SceneRay& ray) {
  const Daylight& day = *ray.daylight;
  const float up = std::max(ray.d_W.z(), 0.0f), rest = 1 - up;
  Vector3f colour = day.zenith + (ray.air - day.zenith) * (rest * rest * rest * rest * rest);
  if (ray.d_W.z() > 0.01f) {
    // A layer of clouds, flattened towards the horizon as by perspective.
    const float scale = 1.4f / (ray.d_W.z() + 0.12f);
    const float x = ray.d_W.x() * scale, y = ray.d_W.y() * scale;
    const float footprint = ray.footprint_rad * scale * 4;
    const float density = FractalNoise(x * 2.2f, y * 2.2f, 7, footprint, 101);
    const float from = 0.62f - 0.3f * day.clouds;
    const float thick = SmoothStep(from, from + 0.24f, density) * SmoothStep(0, 0.3f, day.clouds);
    if (thick > 0) {
      const float shade = FractalNoise(x * 2.2f + 0.15f, y * 2.2f + 0.1f, 5, footprint, 101);
      const Vector3f cloud = day.cloud_light * (1.22f - (0.55f - 0.3f * day.overcast) * shade);
      Blend(cloud, thick * SmoothStep(0.01f, 0.09f, ray.d_W.z()), &colour);
    }
  }
  const float to_sun = std::max(ray.d_W.dot(day.sun_direction), 0.0f);
  const float clear = 1 - day.overcast;
  const float power2 = to_sun * to_sun, power4 = power2 * power2, power8 = power4 * power4;
  const float power16 = power8 * power8, power60 = power16 * power16 * power16 * power8 * power4;
  colour += day.sun_colour * (clear * (0.25f + 0.2f * day.dusk) * power60);
  colour += day.sun_colour * (0.3f * day.dusk * day.surface_light.x() * power8);
  // 0.5° across.
  const float disc = SmoothStep(0, 1, 0.5f + (to_sun - 0.99996f) / (0.009f * ray.footprint_rad));
  Blend(4 * day.sun_colour, disc * clear, &colour);
  return ray.air + day.ThroughFog(ray.d_W.z()) * (colour - ray.air);
}

bool TreeRow::CanBeIn(const SceneBounds& bounds) const {
  return bounds.Reaches(distance_m, -0.5f, max_height_m * 1.3f);
}

// Which tree is in front of which does not depend on where one looks.
void TreeRow::Draw(const SceneRay& ray, Seen* seen) const {
  const float z = ray.HeightAt(distance_m);
  if (z < -0.5f || z > max_height_m * 1.3f) return;
  const RingCell cell = CellOf(ray, distance_m, spacing_m);
  struct Candidate {
    float order, x;
    int index;
  };
  std::array<Candidate, 5> candidates;
  std::size_t n = 0;
  const float reach_m = 0.61f * max_height_m * (1 - trunk_share);
  for (int step = -2; step <= 2; ++step) {
    const int index = Wrapped(cell.index + step, cell.count);
    const float jitter = 0.7f * (CellHash(index, 0, seed) - 0.5f);
    const float x = (cell.place - static_cast<float>(step) - 0.5f - jitter) * spacing_m;
    if (std::abs(x) > reach_m) continue;
    candidates[n++] = {CellHash(index, 7, seed), x, index};
    for (std::size_t k = n - 1; k > 0 && candidates[k].order < candidates[k - 1].order; --k) {
      std::swap(candidates[k], candidates[k - 1]);
    }
  }
  for (std::size_t k = 0; k < n && !seen->IsEnough(); ++k) {
    DrawTree(*this, candidates[k].index, ray, candidates[k].x, z, seen);
  }
}

bool BuildingRow::CanBeIn(const SceneBounds& bounds) const {
  return bounds.Reaches(distance_m, -1, max_height_m + 3);
}

void BuildingRow::Draw(const SceneRay& ray, Seen* seen) const {
  const float z = ray.HeightAt(distance_m);
  if (z < -1 || z > max_height_m + 3) return;
  const RingCell cell = CellOf(ray, distance_m, plot_m);
  const int index = Wrapped(cell.index, cell.count);
  if (CellHash(index, 4, seed) < gap_share) return;
  const float footprint = ray.footprint_rad * distance_m;
  const float height =
      std::round((min_height_m + (max_height_m - min_height_m) * CellHash(index, 1, seed)) / 3.1f) *
          3.1f +
      0.9f;
  const float margin = 0.03f + 0.12f * CellHash(index, 2, seed);
  const float x = cell.place * plot_m;
  const float inside = BandCoverage(x, margin * plot_m, (1 - margin) * plot_m, footprint) *
                       BandCoverage(z, -1, height, footprint);
  if (inside <= 0) return;
  Vector3f wall = Facade(index, x - margin * plot_m, z, footprint, seed);
  // Walls stand aslant: the sun is before some and behind others.
  const float turn = 1.6f * (CellHash(index, 9, seed) - 0.5f);
  const SunSide sun(ray);
  const float facing = sun.left * std::sin(turn) - sun.ahead * std::cos(turn);
  wall *= 0.75f + 0.25f * SmoothStep(0, 0.35f, facing) - 0.15f * SmoothStep(0, 0.35f, -facing);
  Blend(Vector3f(0.12f, 0.12f, 0.13f), BandCoverage(z, height - 0.5f, height, footprint), &wall);
  seen->Add(ray.Lit(wall, distance_m), inside);
}

bool Fence::CanBeIn(const SceneBounds& bounds) const {
  return bounds.Reaches(distance_m, -0.2f, height_m + 0.2f);
}

void Fence::Draw(const SceneRay& ray, Seen* seen) const {
  const float z = ray.HeightAt(distance_m);
  if (z < -0.2f || z > height_m + 0.2f) return;
  const float footprint = ray.footprint_rad * distance_m;
  const int posts = static_cast<int>(std::lround(2 * kPi * distance_m / post_spacing_m));
  const float spacing = 2 * kPi * distance_m / static_cast<float>(posts);
  const float x = (ray.azimuth_rad + kPi) * distance_m;
  const float within = BandCoverage(z, 0, height_m, footprint);
  const float post = StripeCoverage(x, spacing, 0.06f / spacing, footprint);
  const float rail = BandCoverage(z, height_m - 0.06f, height_m, footprint) +
                     BandCoverage(z, height_m / 2 - 0.03f, height_m / 2 + 0.03f, footprint);
  seen->Add(ray.Lit(wire_colour * 1.3f, distance_m), within * std::min(post + rail, 1.0f));
  // Diamonds of wire, 5 cm wide: two families of diagonals.
  constexpr float kMesh_m = 0.07f, kWire_share = 0.07f;
  const float wires = 1 - (1 - StripeCoverage(x + z, kMesh_m, kWire_share, footprint * 1.4f)) *
                              (1 - StripeCoverage(x - z, kMesh_m, kWire_share, footprint * 1.4f));
  seen->Add(ray.Lit(wire_colour, distance_m), within * wires);
}

bool Mast::CanBeIn(const SceneBounds& bounds) const {
  return bounds.Reaches(distance_m, -0.5f, height_m + head_height_m + 0.5f) &&
         bounds.LooksTo(azimuth_deg, distance_m, Reach_m());
}

void Mast::Draw(const SceneRay& ray, Seen* seen) const {
  const float z = ray.HeightAt(distance_m);
  if (z < -0.5f || z > height_m + head_height_m + 0.5f) return;
  const float x = SidewaysOf(ray, azimuth_deg, distance_m);
  if (std::abs(x) > Reach_m()) return;
  const float footprint = ray.footprint_rad * distance_m;
  const float pole =
      BandCoverage(x, -radius_m, radius_m, footprint) * BandCoverage(z, 0, height_m, footprint);
  const float head = BandCoverage(x, -head_width_m / 2, head_width_m / 2, footprint) *
                     BandCoverage(z, height_m, height_m + head_height_m, footprint);
  const float lamps = StripeCoverage(x, head_width_m / 4, 0.7f, footprint) *
                      StripeCoverage(z - height_m, head_height_m / 2, 0.7f, footprint);
  seen->Add(ray.Lit(colour * 0.6f + lamps * Vector3f::Constant(0.5f), distance_m), head);
  seen->Add(ray.Lit(colour, distance_m), pole);
}

bool Hoop::CanBeIn(const SceneBounds& bounds) const {
  return bounds.Reaches(distance_m, -0.2f, 4.3f) && bounds.LooksTo(azimuth_deg, distance_m, 1.5f);
}

void Hoop::Draw(const SceneRay& ray, Seen* seen) const {
  const float x = SidewaysOf(ray, azimuth_deg, distance_m), z = ray.HeightAt(distance_m);
  if (std::abs(x) > 1.5f || z < -0.2f || z > 4.3f) return;
  const float footprint = ray.footprint_rad * distance_m;
  const auto box = [&](float x0, float x1, float z0, float z1) {
    return BandCoverage(x, x0, x1, footprint) * BandCoverage(z, z0, z1, footprint);
  };
  const Vector3f steel(0.16f, 0.17f, 0.19f), red(0.55f, 0.06f, 0.03f), white(0.8f, 0.8f, 0.8f);
  // FIBA: board 1.80 × 1.05 m from 2.90 m, inner rectangle 0.59 × 0.45 m, ring 0.45 m at 3.05 m.
  seen->Add(Vector3f(0.75f, 0.16f, 0.03f), box(-0.245f, 0.245f, 3.02f, 3.07f));
  const float taper = 0.225f - 0.10f * (3.05f - z) / 0.45f;
  const float net = StripeCoverage(x + z, 0.09f, 0.25f, footprint) +
                    StripeCoverage(x - z, 0.09f, 0.25f, footprint);
  seen->Add(white, std::min(net, 1.0f) * box(-taper, taper, 2.60f, 3.03f));
  seen->Add(white, box(-0.245f, 0.245f, 3.10f, 3.45f));
  seen->Add(red, box(-0.295f, 0.295f, 3.05f, 3.50f));
  seen->Add(white, box(-0.90f, 0.90f, 2.90f, 3.95f));
  seen->Add(red, box(-0.93f, 0.93f, 2.87f, 3.98f));
  seen->Add(steel, box(-0.10f, 0.10f, 0, 3.1f));
}

}  // namespace windhover
