#include <cmath>
#include <numbers>

#include "common/geometry/rotation.h"
#include "render/aircraft_meshes.h"
#include "render/mesh_builder.h"

namespace windhover {
namespace {

using Eigen::Vector3f;

// Heights of the hexacopter are above its feet.
constexpr float kHexMotor_m = 0.275f, kHexPropellerRadius_m = 0.127f;
constexpr float kHexArmZ_m = 0.20f, kHexDiscZ_m = 0.25f, kHexHeight_m = 0.31f;

const Vector3f kWhite = ColourFromSrgb(225, 226, 228);
const Vector3f kRed = ColourFromSrgb(178, 26, 32);
const Vector3f kBlack = ColourFromSrgb(28, 28, 31);
const Vector3f kGrey = ColourFromSrgb(128, 130, 134);
const Vector3f kBlue = ColourFromSrgb(24, 60, 150);

void AddHexacopterArm(int arm, AircraftModel* model) {
  const double angle_rad = std::numbers::pi / 6 + arm * std::numbers::pi / 3;
  const Vector3f out(static_cast<float>(std::cos(angle_rad)),
                     static_cast<float>(std::sin(angle_rad)), 0);
  const Vector3f up(0, 0, 1), motor = kHexMotor_m * out + kHexArmZ_m * up;
  const Vector3f& colour = arm == 0 || arm == 5 ? kRed : kWhite;  // The two in front.
  AddTube(0.06f * out + kHexArmZ_m * up, motor, 0.020f, 0.011f, 12, colour, &model->body);
  AddTube(motor - 0.012f * up, motor + 0.036f * up, 0.017f, 0.015f, 16, kBlack, &model->body);
  AddPropeller(arm % 4, {motor.x(), motor.y(), kHexDiscZ_m}, kHexPropellerRadius_m, kBlack, model);
  if (arm % 2 == 1) return;
  AddTube(0.09f * out + kHexArmZ_m * up, 0.16f * out, 0.007f, 0.007f, 10, kBlack, &model->body);
}

void AddWing(float side, Mesh* mesh) {
  constexpr double kSweep_rad = 0.45;
  constexpr float kHalfSpan_m = 0.43f, kChord_m = 0.19f, kThick_m = 0.018f, kRound_m = 0.008f;
  const Eigen::Matrix3f R =
      RotationFromVector(Eigen::Vector3d(0, 0, side * kSweep_rad)).cast<float>();
  const auto sine = static_cast<float>(std::sin(kSweep_rad));
  const auto cosine = static_cast<float>(std::cos(kSweep_rad));
  // The span ends at the rounded corner in front.
  const float length_m =
      kRound_m + (kHalfSpan_m - kRound_m - (kChord_m / 2 - kRound_m) * sine) / cosine;
  Mesh wing;
  AddRoundedBox({0, side * length_m / 2, 0}, {kChord_m, length_m, kThick_m}, kRound_m, kWhite,
                &wing);
  AddRoundedBox({kChord_m * 0.3f, side * length_m / 2, 0.002f},
                {kChord_m * 0.3f, length_m * 0.9f, kThick_m}, kRound_m, kBlue, &wing);
  AddRoundedBox({-0.01f, side * (length_m - 0.006f), 0.03f}, {kChord_m * 0.9f, 0.010f, 0.11f},
                0.004f, kRed, &wing);
  AppendPlaced(wing, R, Vector3f::Zero(), mesh);
}

}  // namespace

AircraftModel MakeHexacopter() {
  AircraftModel model;
  AddTube({0, 0, kHexArmZ_m - 0.022f}, {0, 0, kHexArmZ_m + 0.026f}, 0.085f, 0.085f, 24, kBlack,
          &model.body);
  AddEllipsoid({0, 0, kHexArmZ_m + 0.03f}, {0.075f, 0.075f, 0.05f}, 20, kGrey, &model.body);
  AddTube({-0.05f, 0, kHexArmZ_m}, {-0.05f, 0, kHexHeight_m - 0.012f}, 0.005f, 0.005f, 10, kBlack,
          &model.body);
  AddTube({-0.05f, 0, kHexHeight_m - 0.012f}, {-0.05f, 0, kHexHeight_m}, 0.03f, 0.03f, 16, kWhite,
          &model.body);
  for (int arm = 0; arm < 6; ++arm) AddHexacopterArm(arm, &model);
  return Centred(std::move(model));
}

AircraftModel MakeFlyingWing() {
  AircraftModel model;
  AddEllipsoid({0.02f, 0, 0}, {0.19f, 0.05f, 0.045f}, 20, kWhite, &model.body);
  AddTube({-0.17f, 0, 0}, {-0.21f, 0, 0}, 0.018f, 0.014f, 14, kBlack, &model.body);
  for (const float side : {-1.0f, 1.0f}) AddWing(side, &model.body);
  return Centred(std::move(model));
}

}  // namespace windhover
