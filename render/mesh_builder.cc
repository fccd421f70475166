#include "render/mesh_builder.h"

#include <cmath>

#include "common/image/srgb.h"

namespace windhover {
namespace {

using Eigen::Vector3f;

std::uint32_t AddVertex(const Vector3f& p, const Vector3f& normal, const Vector3f& colour,
                        Mesh* mesh) {
  mesh->positions.push_back(p);
  mesh->normals.push_back(normal);
  mesh->base_colours.push_back(colour);
  return static_cast<std::uint32_t>(mesh->positions.size() - 1);
}

// A triangle whose corners have different places (others are left out), turned so that it
// faces along its vertices' normals.
void AddTriangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, Mesh* mesh) {
  const Vector3f &pa = mesh->positions[a], &pb = mesh->positions[b], &pc = mesh->positions[c];
  if (pa == pb || pb == pc || pc == pa) return;
  const Vector3f facing = (pb - pa).cross(pc - pa);
  const Vector3f outward = mesh->normals[a] + mesh->normals[b] + mesh->normals[c];
  if (facing.dot(outward) < 0) std::swap(b, c);
  mesh->triangles.push_back({a, b, c});
}

void AddQuad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, Mesh* mesh) {
  AddTriangle(a, b, c, mesh);
  AddTriangle(a, c, d, mesh);
}

// Unit vectors around the z axis. The last equals the first exactly, so that surfaces close.
std::vector<Eigen::Vector2f> Circle(int sides) {
  std::vector<Eigen::Vector2f> points;
  for (int i = 0; i < sides; ++i) {
    const double angle_rad = 2 * EIGEN_PI * i / sides;
    points.emplace_back(static_cast<float>(std::cos(angle_rad)),
                        static_cast<float>(std::sin(angle_rad)));
  }
  points.push_back(points.front());
  return points;
}

// Lattice over one half-axis of a rounded box: two rows over the rounding, mirrored.
std::vector<float> Lattice(float half, float radius) {
  const float inner = half - radius;
  const float bend = radius * 0.41421356f;  // tan(22.5°): halves the corner's angle.
  return {-half, -inner - bend, -inner, inner, inner + bend, half};
}

// From a point on the sharp box to the rounded one (Minkowski sum of an inner box and a ball).
void RoundedPoint(const Vector3f& sharp, const Vector3f& half, float radius, Vector3f* p,
                  Vector3f* normal) {
  const Vector3f inner_half = half - Vector3f::Constant(radius);
  const Vector3f inner = sharp.cwiseMin(inner_half).cwiseMax(-inner_half);
  *normal = (sharp - inner).normalized();
  *p = inner + radius * *normal;
}

void AddRoundedFace(int axis, float sign, const Vector3f& centre, const Vector3f& half,
                    float radius, const Vector3f& colour, Mesh* mesh) {
  const int axis_u = (axis + 1) % 3, axis_v = (axis + 2) % 3;
  const std::vector<float> us = Lattice(half[axis_u], radius), vs = Lattice(half[axis_v], radius);
  const auto base = static_cast<std::uint32_t>(mesh->positions.size());
  for (const float u : us) {
    for (const float v : vs) {
      Vector3f sharp, p, normal;
      sharp[axis] = sign * half[axis];
      sharp[axis_u] = u;
      sharp[axis_v] = v;
      RoundedPoint(sharp, half, radius, &p, &normal);
      AddVertex(centre + p, normal, colour, mesh);
    }
  }
  const auto n = static_cast<std::uint32_t>(vs.size());
  for (std::uint32_t i = 0; i + 1 < us.size(); ++i) {
    for (std::uint32_t j = 0; j + 1 < n; ++j) {
      const std::uint32_t a = base + i * n + j;
      AddQuad(a, a + n, a + n + 1, a + 1, mesh);
    }
  }
}

void AddCap(const std::vector<Vector3f>& ring, const Vector3f& centre, const Vector3f& normal,
            const Vector3f& colour, Mesh* mesh) {
  const std::uint32_t hub = AddVertex(centre, normal, colour, mesh);
  for (const Vector3f& p : ring) AddVertex(p, normal, colour, mesh);
  for (std::uint32_t i = 1; i < ring.size(); ++i) AddTriangle(hub, hub + i, hub + i + 1, mesh);
}

// One side of what a propeller sweeps: rings about its hub, closest where its opacity changes most.
void AddDiscFace(const Vector3f& middle, const Vector3f& normal, float radius_m,
                 const std::vector<Eigen::Vector2f>& circle, const Vector3f& colour, Mesh* mesh) {
  std::uint32_t inner = 0;
  const auto n = static_cast<std::uint32_t>(circle.size());
  const std::uint32_t hub = AddVertex(middle, normal, colour, mesh);
  for (const float share : {0.12f, 0.3f, 0.6f, 0.93f, 1.0f}) {
    const auto ring = static_cast<std::uint32_t>(mesh->positions.size());
    for (const Eigen::Vector2f& c : circle) {
      AddVertex(middle + Vector3f(c.x(), c.y(), 0) * (share * radius_m), normal, colour, mesh);
    }
    for (std::uint32_t i = 0; i + 1 < n; ++i) {
      if (inner == 0) {
        AddTriangle(hub, ring + i, ring + i + 1, mesh);
      } else {
        AddQuad(inner + i, ring + i, ring + i + 1, inner + i + 1, mesh);
      }
    }
    inner = ring;
  }
}

void AddDiscRim(const Vector3f& hub, float radius_m, const std::vector<Eigen::Vector2f>& circle,
                const Vector3f& colour, Mesh* mesh) {
  const auto base = static_cast<std::uint32_t>(mesh->positions.size());
  const Vector3f half_height(0, 0, Propeller::kHeight_m / 2);
  for (const Eigen::Vector2f& c : circle) {
    const Vector3f radial(c.x(), c.y(), 0);
    AddVertex(hub + radius_m * radial - half_height, radial, colour, mesh);
    AddVertex(hub + radius_m * radial + half_height, radial, colour, mesh);
  }
  for (std::uint32_t i = 0; i + 1 < circle.size(); ++i) {
    const std::uint32_t a = base + 2 * i;
    AddQuad(a, a + 2, a + 3, a + 1, mesh);
  }
}

}  // namespace

void AddRoundedBox(const Vector3f& centre_m, const Vector3f& size_m, float radius_m,
                   const Vector3f& colour, Mesh* mesh) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0f, 1.0f}) {
      AddRoundedFace(axis, sign, centre_m, size_m / 2, radius_m, colour, mesh);
    }
  }
}

void AddTube(const Vector3f& from_m, const Vector3f& to_m, float from_radius_m, float to_radius_m,
             int sides, const Vector3f& colour, Mesh* mesh) {
  const Vector3f axis = (to_m - from_m).normalized();
  const Vector3f side = axis.unitOrthogonal(), other = axis.cross(side);
  std::vector<Vector3f> from_ring, to_ring;
  const auto base = static_cast<std::uint32_t>(mesh->positions.size());
  for (const Eigen::Vector2f& c : Circle(sides)) {
    const Vector3f radial = side * c.x() + other * c.y();
    from_ring.push_back(from_m + radial * from_radius_m);
    to_ring.push_back(to_m + radial * to_radius_m);
    AddVertex(from_ring.back(), radial, colour, mesh);
    AddVertex(to_ring.back(), radial, colour, mesh);
  }
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(sides); ++i) {
    const std::uint32_t a = base + 2 * i;
    AddQuad(a, a + 2, a + 3, a + 1, mesh);
  }
  AddCap(from_ring, from_m, -axis, colour, mesh);
  AddCap(to_ring, to_m, axis, colour, mesh);
}

void AddEllipsoid(const Vector3f& centre_m, const Vector3f& radii_m, int sides,
                  const Vector3f& colour, Mesh* mesh) {
  const std::vector<Eigen::Vector2f> circle = Circle(sides);
  const int rows = sides / 2;
  const auto base = static_cast<std::uint32_t>(mesh->positions.size());
  for (int row = 0; row <= rows; ++row) {
    const double polar_rad = EIGEN_PI * row / rows;
    const bool is_pole = row == 0 || row == rows;
    const float r = is_pole ? 0 : static_cast<float>(std::sin(polar_rad));
    const auto z = static_cast<float>(std::cos(polar_rad));
    for (const Eigen::Vector2f& c : circle) {
      const Vector3f unit(r * c.x(), r * c.y(), z);
      AddVertex(centre_m + radii_m.cwiseProduct(unit), unit.cwiseQuotient(radii_m).normalized(),
                colour, mesh);
    }
  }
  const auto n = static_cast<std::uint32_t>(circle.size());
  for (std::uint32_t row = 0; row < static_cast<std::uint32_t>(rows); ++row) {
    for (std::uint32_t i = 0; i + 1 < n; ++i) {
      const std::uint32_t a = base + row * n + i;
      AddQuad(a, a + n, a + n + 1, a + 1, mesh);
    }
  }
}

void AddPropeller(int rotor, const Vector3f& hub_m, float radius_m, const Vector3f& colour,
                  AircraftModel* model) {
  model->propellers.push_back({hub_m, radius_m, rotor});
  const std::vector<Eigen::Vector2f> circle = Circle(kDiscSectors);
  for (const float sign : {-1.0f, 1.0f}) {
    const Vector3f normal(0, 0, sign), middle = hub_m + normal * (Propeller::kHeight_m / 2);
    AddDiscFace(middle, normal, radius_m, circle, colour, &model->rotor_discs);
  }
  AddDiscRim(hub_m, radius_m, circle, colour, &model->rotor_discs);
}

void MoveToMiddle(float height_m, AircraftModel* model) {
  const Vector3f to_middle(0, 0, -height_m / 2);
  for (Vector3f& p : model->body.positions) p += to_middle;
  for (Vector3f& p : model->rotor_discs.positions) p += to_middle;
  for (Propeller& propeller : model->propellers) propeller.hub_m += to_middle;
}

AircraftModel Centred(AircraftModel model) {
  const Vector3f middle = BoundingBox(model.body).merged(BoundingBox(model.rotor_discs)).center();
  for (Vector3f& p : model.body.positions) p -= middle;
  for (Vector3f& p : model.rotor_discs.positions) p -= middle;
  for (Propeller& propeller : model.propellers) propeller.hub_m -= middle;
  return model;
}

void AppendPlaced(Mesh part, const Eigen::Matrix3f& R, const Vector3f& t_m, Mesh* mesh) {
  for (Vector3f& p : part.positions) p = R * p + t_m;
  for (Vector3f& n : part.normals) n = R * n;
  Append(part, mesh);
}

Vector3f ColourFromSrgb(int red, int green, int blue) {
  return Vector3f(static_cast<float>(LinearFromSrgb(red / 255.0)),
                  static_cast<float>(LinearFromSrgb(green / 255.0)),
                  static_cast<float>(LinearFromSrgb(blue / 255.0)));
}

}  // namespace windhover
