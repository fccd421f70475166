#include "render/aircraft_meshes.h"
#include "render/mesh_builder.h"

namespace windhover {
namespace {

using Eigen::Vector3f;

// Heights are above the landing gear's feet; the origin is moved to the box's centre at the end.
constexpr float kHeight_m = 0.378f;
constexpr float kMotorX_m = 0.2275f, kMotorY_m = 0.224f;
constexpr float kPropellerRadius_m = 0.216f;
constexpr float kDiscZ_m = 0.362f;
constexpr float kBodyZ_m = 0.255f;

const Vector3f kDark = ColourFromSrgb(52, 54, 58);
const Vector3f kBlack = ColourFromSrgb(34, 35, 38);
const Vector3f kGrey = ColourFromSrgb(110, 112, 115);
const Vector3f kLens = ColourFromSrgb(12, 14, 24);

void AddFuselage(const Vector3f& shell, Mesh* mesh) {
  AddRoundedBox({0, 0, kBodyZ_m}, {0.40f, 0.16f, 0.11f}, 0.045f, shell, mesh);
  AddRoundedBox({0.02f, 0, kBodyZ_m + 0.052f}, {0.27f, 0.13f, 0.05f}, 0.02f, shell, mesh);
  // Two batteries side by side at the back.
  for (const float y : {-0.036f, 0.036f}) {
    AddRoundedBox({-0.115f, y, kBodyZ_m + 0.06f}, {0.16f, 0.062f, 0.07f}, 0.014f, kDark, mesh);
  }
  // Front sensors and the beacon.
  AddRoundedBox({0.185f, 0, kBodyZ_m + 0.005f}, {0.05f, 0.11f, 0.05f}, 0.015f, kBlack, mesh);
  AddEllipsoid({0.08f, 0, kBodyZ_m + 0.082f}, {0.016f, 0.016f, 0.018f}, 12, kGrey, mesh);
}

void AddNoseCamera(Mesh* mesh) {
  AddTube({0.15f, 0, kBodyZ_m - 0.04f}, {0.15f, 0, kBodyZ_m - 0.085f}, 0.026f, 0.022f, 16, kDark,
          mesh);
  AddRoundedBox({0.15f, 0, kBodyZ_m - 0.115f}, {0.075f, 0.12f, 0.075f}, 0.025f, kGrey, mesh);
  AddTube({0.18f, 0, kBodyZ_m - 0.115f}, {0.215f, 0, kBodyZ_m - 0.115f}, 0.030f, 0.027f, 20, kLens,
          mesh);
}

void AddArm(float sign_x, float sign_y, Mesh* mesh) {
  const Vector3f root(sign_x * 0.15f, sign_y * 0.06f, kBodyZ_m + 0.01f);
  const Vector3f tip(sign_x * kMotorX_m, sign_y * kMotorY_m, kBodyZ_m + 0.04f);
  AddTube(root, tip, 0.017f, 0.014f, 14, kDark, mesh);
  AddEllipsoid(root, Vector3f::Constant(0.026f), 12, kDark, mesh);
  const Vector3f motor(tip.x(), tip.y(), kBodyZ_m + 0.022f);
  AddTube(motor, motor + Vector3f(0, 0, 0.045f), 0.024f, 0.026f, 20, kBlack, mesh);
  AddTube(motor + Vector3f(0, 0, 0.045f), motor + Vector3f(0, 0, 0.080f), 0.026f, 0.024f, 20, kGrey,
          mesh);
  AddTube(motor + Vector3f(0, 0, 0.080f), {tip.x(), tip.y(), kHeight_m}, 0.012f, 0.009f, 12, kBlack,
          mesh);
}

void AddLandingLeg(float sign_y, Mesh* mesh) {
  constexpr float kSkidRadius_m = 0.011f;
  const float foot_y = sign_y * 0.165f;
  const Vector3f top(0.0f, sign_y * 0.062f, kBodyZ_m - 0.035f);
  const Vector3f foot(-0.01f, foot_y, kSkidRadius_m);
  AddTube(top, foot, 0.013f, 0.011f, 12, kDark, mesh);
  AddTube({-0.17f, foot_y, kSkidRadius_m}, {0.15f, foot_y, kSkidRadius_m}, kSkidRadius_m,
          kSkidRadius_m, 12, kBlack, mesh);
}

}  // namespace

AircraftModel MakeM200(bool orange) {
  const Vector3f shell = orange ? ColourFromSrgb(235, 110, 20) : ColourFromSrgb(41, 43, 46);
  AircraftModel model;
  AddFuselage(shell, &model.body);
  AddNoseCamera(&model.body);
  for (const float sign_y : {-1.0f, 1.0f}) {
    AddLandingLeg(sign_y, &model.body);
    for (const float sign_x : {-1.0f, 1.0f}) {
      AddArm(sign_x, sign_y, &model.body);
      AddPropeller(RotorAt(sign_x, sign_y), {sign_x * kMotorX_m, sign_y * kMotorY_m, kDiscZ_m},
                   kPropellerRadius_m, kDark, &model);
    }
  }
  MoveToMiddle(kHeight_m, &model);
  return model;
}

}  // namespace windhover
