#include "render/aircraft_meshes.h"
#include "render/mesh_builder.h"

namespace windhover {
namespace {

using Eigen::Vector3f;

// Heights are above the landing gear's feet; the origin is moved to the box's centre at the end.
constexpr float kHeight_m = 0.392f;
constexpr float kMotor_m = 0.2121f;
constexpr float kPropellerRadius_m = 0.194f;
constexpr float kCanRadius_m = 0.0229f;  // Motor cans bound the body: 2 (212.1 + 22.9) = 470 mm.
constexpr float kDiscZ_m = 0.250f;

const Vector3f kCarbon = ColourFromSrgb(25, 25, 28);
const Vector3f kPlate = ColourFromSrgb(45, 46, 50);
const Vector3f kGrey = ColourFromSrgb(120, 122, 125);
const Vector3f kWhite = ColourFromSrgb(205, 207, 210);
const Vector3f kLens = ColourFromSrgb(12, 14, 24);

void AddDeck(Mesh* mesh) {
  AddRoundedBox({0.0175f, 0, 0.171f}, {0.235f, 0.196f, 0.016f}, 0.007f, kCarbon, mesh);
  AddRoundedBox({0.0175f, 0, 0.221f}, {0.235f, 0.196f, 0.014f}, 0.006f, kPlate, mesh);
  AddRoundedBox({0.005f, 0, 0.196f}, {0.15f, 0.12f, 0.048f}, 0.012f, kCarbon, mesh);
  AddRoundedBox({0.01f, 0, 0.246f}, {0.16f, 0.09f, 0.044f}, 0.012f, kPlate, mesh);  // Battery.
  AddRoundedBox({0.11f, 0, 0.12f}, {0.04f, 0.05f, 0.08f}, 0.012f, kGrey, mesh);     // Pod.
  AddTube({0.126f, 0, 0.118f}, {0.140f, 0, 0.118f}, 0.017f, 0.015f, 16, kLens, mesh);
}

void AddMast(float sign_y, Mesh* mesh) {
  const float y = sign_y * 0.18f;
  AddTube({0, sign_y * 0.09f, 0.225f}, {0, y, 0.235f}, 0.008f, 0.008f, 10, kCarbon, mesh);
  AddTube({0, y, 0.228f}, {0, y, 0.365f}, 0.006f, 0.006f, 10, kCarbon, mesh);
  AddTube({0, y, 0.362f}, {0, y, kHeight_m}, 0.030f, 0.026f, 20, kWhite, mesh);  // GNSS antenna.
}

void AddArm(float sign_x, float sign_y, Mesh* mesh) {
  const Vector3f tip(sign_x * kMotor_m, sign_y * kMotor_m, 0.197f);
  AddTube({sign_x * 0.07f, sign_y * 0.07f, 0.195f}, tip, 0.0125f, 0.0125f, 14, kCarbon, mesh);
  AddTube(tip - Vector3f(0, 0, 0.014f), tip + Vector3f(0, 0, 0.013f), 0.0225f, kCanRadius_m, 20,
          kPlate, mesh);
  AddTube(tip + Vector3f(0, 0, 0.013f), tip + Vector3f(0, 0, 0.043f), kCanRadius_m, kCanRadius_m,
          20, kGrey, mesh);
  AddTube(tip + Vector3f(0, 0, 0.043f), tip + Vector3f(0, 0, 0.060f), 0.010f, 0.008f, 12, kCarbon,
          mesh);
}

void AddLandingLeg(float sign_y, Mesh* mesh) {
  constexpr float kSkidRadius_m = 0.009f;
  const float foot_y = sign_y * 0.145f;
  for (const float x : {-0.06f, 0.06f}) {
    AddTube({x, sign_y * 0.075f, 0.168f}, {x, foot_y, kSkidRadius_m}, 0.009f, 0.009f, 12, kCarbon,
            mesh);
  }
  AddTube({-0.141f, foot_y, kSkidRadius_m}, {0.141f, foot_y, kSkidRadius_m}, kSkidRadius_m,
          kSkidRadius_m, 12, kCarbon, mesh);
}

}  // namespace

AircraftModel MakeP600() {
  AircraftModel model;
  AddDeck(&model.body);
  for (const float sign_y : {-1.0f, 1.0f}) {
    AddMast(sign_y, &model.body);
    AddLandingLeg(sign_y, &model.body);
    for (const float sign_x : {-1.0f, 1.0f}) {
      AddArm(sign_x, sign_y, &model.body);
      AddPropeller(RotorAt(sign_x, sign_y), {sign_x * kMotor_m, sign_y * kMotor_m, kDiscZ_m},
                   kPropellerRadius_m, kGrey, &model);
    }
  }
  MoveToMiddle(kHeight_m, &model);
  return model;
}

}  // namespace windhover
