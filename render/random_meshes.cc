#include "render/random_meshes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/rotation.h"
#include "render/mesh_builder.h"

namespace windhover {
namespace {

using Eigen::Vector3f;

float Draw(RandomStream* random, double low, double high) {
  return static_cast<float>(random->Uniform(low, high));
}

// Greys and blacks as often as colours, as of things that people make.
Vector3f AnyColour(RandomStream* random) {
  const double grey = random->Uniform(10, 230);
  const double strength = random->Uniform() < 0.5 ? 12 : 110;
  const auto channel = [&] {
    const double drawn = grey + strength * random->Uniform(-1, 1);
    return static_cast<int>(std::clamp(drawn, 5.0, 250.0));
  };
  const int red = channel(), green = channel(), blue = channel();
  return ColourFromSrgb(red, green, blue);
}

Eigen::Matrix3f Turn(const Vector3f& axis, double angle_rad) {
  return RotationFromVector(axis.cast<double>() * angle_rad).cast<float>();
}

/// What a quadrotor is drawn from.
struct QuadrotorParts {
  float half_m;  ///< From the middle to a motor.
  float motor_x_m, motor_y_m;
  float arm_radius_m, motor_radius_m, propeller_radius_m;
  float hull_z_m;  ///< Height of the hull's middle above the arms' roots.
  Vector3f hull_m;
  Vector3f hull_colour, arm_colour, motor_colour, propeller_colour;
};

QuadrotorParts DrawParts(RandomStream* random) {
  QuadrotorParts parts;
  parts.half_m = 0.5f * 0.25f * std::pow(1.1f / 0.25f, Draw(random, 0, 1));
  const double spread_rad = random->Uniform(0.60, 0.95);  // Of a front arm from straight ahead.
  parts.motor_x_m = parts.half_m * static_cast<float>(std::cos(spread_rad));
  parts.motor_y_m = parts.half_m * static_cast<float>(std::sin(spread_rad));
  const float room_m = std::min(parts.motor_x_m, parts.motor_y_m);
  parts.propeller_radius_m = room_m * Draw(random, 0.65, 0.97);
  parts.arm_radius_m = parts.half_m * Draw(random, 0.03, 0.07);
  parts.motor_radius_m = parts.half_m * Draw(random, 0.06, 0.10);
  parts.hull_m = parts.half_m *
                 Vector3f{Draw(random, 0.6, 1.3), Draw(random, 0.35, 0.8), Draw(random, 0.2, 0.5)};
  parts.hull_z_m = parts.half_m * Draw(random, -0.12, 0.12);
  parts.hull_colour = AnyColour(random);
  parts.arm_colour = random->Uniform() < 0.5 ? parts.hull_colour : AnyColour(random);
  parts.motor_colour = AnyColour(random);
  parts.propeller_colour = AnyColour(random);
  return parts;
}

void AddHull(const QuadrotorParts& parts, RandomStream* random, Mesh* mesh) {
  const Vector3f middle(0, 0, parts.hull_z_m);
  if (random->Uniform() < 0.5) {
    AddEllipsoid(middle, parts.hull_m / 2, 20, parts.hull_colour, mesh);
  } else {
    const float radius_m = parts.hull_m.minCoeff() * Draw(random, 0.1, 0.45);
    AddRoundedBox(middle, parts.hull_m, radius_m, parts.hull_colour, mesh);
  }
  if (random->Uniform() < 0.6) {  // A battery or antenna on top.
    const Vector3f size = parts.hull_m.cwiseProduct(Vector3f{Draw(random, 0.2, 0.6), 0.4f, 0.4f});
    AddRoundedBox(middle + Vector3f(0, 0, parts.hull_m.z() * 0.5f), size, size.minCoeff() * 0.3f,
                  AnyColour(random), mesh);
  }
  if (random->Uniform() < 0.6) {  // A camera below the nose.
    const float radius_m = parts.half_m * Draw(random, 0.08, 0.16);
    AddEllipsoid(
        middle + Vector3f(parts.hull_m.x() * 0.35f, 0, -parts.hull_m.z() * 0.5f - radius_m),
        Vector3f::Constant(radius_m), 14, AnyColour(random), mesh);
  }
}

void AddMotors(const QuadrotorParts& parts, float lift_m, AircraftModel* model) {
  for (const float sign_x : {-1.0f, 1.0f}) {
    for (const float sign_y : {-1.0f, 1.0f}) {
      const Vector3f tip(sign_x * parts.motor_x_m, sign_y * parts.motor_y_m, lift_m);
      AddTube({tip.x() * 0.15f, tip.y() * 0.15f, 0}, tip, parts.arm_radius_m, parts.arm_radius_m,
              12, parts.arm_colour, &model->body);
      const float top_m = parts.motor_radius_m * 1.6f;
      AddTube(tip - Vector3f(0, 0, parts.motor_radius_m * 0.6f), tip + Vector3f(0, 0, top_m),
              parts.motor_radius_m, parts.motor_radius_m * 0.9f, 16, parts.motor_colour,
              &model->body);
      AddPropeller(RotorAt(sign_x, sign_y), tip + Vector3f(0, 0, top_m + 0.008f),
                   parts.propeller_radius_m, parts.propeller_colour, model);
    }
  }
}

void AddLegs(const QuadrotorParts& parts, RandomStream* random, Mesh* mesh) {
  const float length_m = parts.half_m * Draw(random, 0.3, 0.8);
  const float radius_m = parts.arm_radius_m * Draw(random, 0.4, 0.8);
  const bool has_skids = random->Uniform() < 0.5;
  const Vector3f colour = random->Uniform() < 0.5 ? parts.arm_colour : AnyColour(random);
  const float x = parts.half_m * 0.35f, out_m = parts.half_m * Draw(random, 0.3, 0.55);
  for (const float sign_y : {-1.0f, 1.0f}) {
    for (const float sign_x : {-1.0f, 1.0f}) {
      AddTube({sign_x * x * 0.6f, sign_y * parts.hull_m.y() * 0.3f, parts.hull_z_m},
              {sign_x * x, sign_y * out_m, -length_m}, radius_m, radius_m, 10, colour, mesh);
    }
    if (!has_skids) continue;
    AddTube({-x * 1.6f, sign_y * out_m, -length_m}, {x * 1.6f, sign_y * out_m, -length_m}, radius_m,
            radius_m, 10, colour, mesh);
  }
}

void AddWings(float half_span_m, float chord_m, const Vector3f& colour, RandomStream* random,
              Mesh* mesh) {
  const double beat_rad = random->Uniform(-0.7, 1.0), sweep_rad = random->Uniform(-0.2, 0.5);
  const double fold_rad = beat_rad * random->Uniform(-0.6, 0.3);  // The hand against the arm.
  for (const float side : {-1.0f, 1.0f}) {
    const Eigen::Matrix3f R_arm = Turn(Vector3f::UnitX(), side * beat_rad);
    const Eigen::Matrix3f R_hand = Turn(Vector3f::UnitX(), side * (beat_rad + fold_rad)) *
                                   Turn(Vector3f::UnitZ(), side * sweep_rad);
    const Vector3f root(0, side * chord_m * 0.1f, 0), out(0, side * half_span_m / 2, 0);
    Mesh arm, hand;
    AddEllipsoid(Vector3f::Zero(), {chord_m / 2, half_span_m * 0.3f, chord_m * 0.05f}, 14, colour,
                 &arm);
    AddEllipsoid(Vector3f::Zero(), {chord_m * 0.36f, half_span_m * 0.3f, chord_m * 0.04f}, 14,
                 colour, &hand);
    const Vector3f wrist = root + R_arm * out;
    AppendPlaced(arm, R_arm, root + R_arm * (out / 2), mesh);
    AppendPlaced(hand, R_hand, wrist + R_hand * (out / 2), mesh);
  }
}

void AddTail(float length_m, float span_m, float height_m, const Vector3f& colour, Mesh* mesh) {
  const float x = -length_m * 0.46f;
  AddEllipsoid({x, 0, 0}, {length_m * 0.06f, span_m * 0.18f, length_m * 0.008f}, 16, colour, mesh);
  AddEllipsoid({x, 0, height_m / 2}, {length_m * 0.06f, length_m * 0.008f, height_m / 2}, 16,
               colour, mesh);
}

Vector3f SomewhereWithin(const Vector3f& half_m, RandomStream* random) {
  return {half_m.x() * Draw(random, -1, 1), half_m.y() * Draw(random, -1, 1),
          half_m.z() * Draw(random, -1, 1)};
}

}  // namespace

AircraftModel MakeRandomQuadrotor(RandomStream* random) {
  const QuadrotorParts parts = DrawParts(random);
  AircraftModel model;
  AddHull(parts, random, &model.body);
  AddMotors(parts, parts.half_m * Draw(random, -0.05, 0.15), &model);
  if (random->Uniform() < 0.8) AddLegs(parts, random, &model.body);
  return Centred(std::move(model));
}

AircraftModel MakeRandomBird(RandomStream* random) {
  const float half_span_m = 0.2f * std::pow(5.0f, Draw(random, 0, 1));
  const float length_m = half_span_m * Draw(random, 0.6, 1.0);
  const Vector3f colour = AnyColour(random);
  AircraftModel model;
  AddEllipsoid(Vector3f::Zero(), {length_m / 2, length_m * 0.13f, length_m * 0.13f}, 16, colour,
               &model.body);
  AddEllipsoid({length_m * 0.5f, 0, length_m * 0.05f}, Vector3f::Constant(length_m * 0.09f), 12,
               AnyColour(random), &model.body);
  AddEllipsoid({-length_m * 0.55f, 0, 0}, {length_m * 0.2f, length_m * 0.12f, length_m * 0.02f}, 12,
               colour, &model.body);
  AddWings(half_span_m, half_span_m * Draw(random, 0.25, 0.5), colour, random, &model.body);
  return Centred(std::move(model));
}

AircraftModel MakeRandomAeroplane(RandomStream* random) {
  const float span_m = std::pow(12.0f, Draw(random, 0, 1)),
              length_m = span_m * Draw(random, 0.6, 1);
  const float girth_m = length_m * Draw(random, 0.05, 0.1);
  const Vector3f colour = AnyColour(random), wings = AnyColour(random);
  AircraftModel model;
  AddEllipsoid(Vector3f::Zero(), {length_m / 2, girth_m, girth_m}, 24, colour, &model.body);
  AddTail(length_m, span_m, length_m * 0.18f, wings, &model.body);
  if (random->Uniform() < 0.7) {
    const float z = girth_m * Draw(random, -0.8, 0.9), chord_m = span_m * Draw(random, 0.1, 0.18);
    AddEllipsoid({length_m * 0.05f, 0, z}, {chord_m / 2, span_m / 2, chord_m * 0.07f}, 24, wings,
                 &model.body);
  } else {  // A helicopter.
    AddTube({length_m * 0.1f, 0, 0}, {length_m * 0.1f, 0, girth_m * 2}, girth_m * 0.2f,
            girth_m * 0.2f, 12, colour, &model.body);
    AddPropeller(0, {length_m * 0.1f, 0, girth_m * 2 + 0.01f}, span_m / 2, wings, &model);
  }
  return Centred(std::move(model));
}

AircraftModel MakeRandomTree(RandomStream* random) {
  const float height_m = Draw(random, 2, 6), width_m = height_m * Draw(random, 0.25, 0.6);
  const int green = static_cast<int>(random->Uniform(50, 130));
  const Vector3f leaves =
      ColourFromSrgb(static_cast<int>(green * random->Uniform(0.5, 1.2)), green, green / 3);
  const Vector3f bark = ColourFromSrgb(74, 60, 47);
  AircraftModel model;
  AddTube({0, 0, 0}, {0, 0, height_m * 0.8f}, height_m * 0.025f, height_m * 0.008f, 10, bark,
          &model.body);
  const int n_lumps = static_cast<int>(random->Uniform(0, 14));
  for (int i = 0; i < 12; ++i) {
    const Vector3f root(0, 0, height_m * Draw(random, 0.35, 0.75));
    const Vector3f tip = root + SomewhereWithin({width_m, width_m, height_m * 0.25f}, random);
    AddTube(root, tip, height_m * 0.008f, height_m * 0.003f, 8, bark, &model.body);
    if (i >= n_lumps) continue;
    const float lump_m = width_m * Draw(random, 0.15, 0.45);
    const Vector3f radii = lump_m * Vector3f{1, Draw(random, 0.7, 1.3), Draw(random, 0.5, 1)};
    AddEllipsoid(tip, radii, 10, leaves * Draw(random, 0.6, 1.3), &model.body);
  }
  return Centred(std::move(model));
}

AircraftModel MakeRandomClutter(RandomStream* random) {
  const float half_m = 0.1f * std::pow(7.5f, Draw(random, 0, 1));
  const int n_parts = 1 + static_cast<int>(random->Uniform(0, 6));
  AircraftModel model;
  Vector3f at = Vector3f::Zero();
  for (int i = 0; i < n_parts; ++i) {
    const Vector3f next = SomewhereWithin(Vector3f::Constant(half_m), random);
    const double kind = random->Uniform();
    const Vector3f colour = AnyColour(random);
    if (kind < 0.4) {
      const float radius_m = half_m * Draw(random, 0.03, 0.2);
      AddTube(at, next, radius_m, radius_m * Draw(random, 0.5, 1), 12, colour, &model.body);
    } else if (kind < 0.75) {
      const Vector3f size =
          half_m * Vector3f{Draw(random, 0.1, 1.5), Draw(random, 0.1, 1.5), Draw(random, 0.05, 1)};
      Mesh box;
      AddRoundedBox(Vector3f::Zero(), size, size.minCoeff() * 0.2f, colour, &box);
      const Vector3f axis = SomewhereWithin(Vector3f::Ones(), random);
      AppendPlaced(box, Turn(axis, random->Uniform(0, std::numbers::pi)), at, &model.body);
    } else {
      const Vector3f radii =
          half_m * Vector3f{Draw(random, 0.1, 0.7), Draw(random, 0.1, 0.7), Draw(random, 0.1, 0.7)};
      AddEllipsoid(at, radii, 16, colour, &model.body);
    }
    at = next;
  }
  return Centred(std::move(model));
}

}  // namespace windhover
