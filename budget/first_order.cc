#include "budget/first_order.h"

#include <array>
#include <cmath>

namespace windhover {
namespace {

double Yaw(double x) { return 1 + x * x; }

double Radial(double x, double y) { return x * (x * x + y * y); }

double RightYaw(const Sight& s) { return s.focal_px * Yaw(s.x_right()); }
double LeftYaw(const Sight& s) { return -s.focal_px * Yaw(s.x); }
double RightPitch(const Sight& s) { return -s.focal_px * s.x_right() * s.y; }
double LeftPitch(const Sight& s) { return s.focal_px * s.x * s.y; }
double RightRoll(const Sight& s) { return -s.focal_px * s.y; }
double LeftRoll(const Sight& s) { return s.focal_px * s.y; }
double RelativeYaw(const Sight& s) { return (RightYaw(s) - LeftYaw(s)) / 2; }
double RelativePitch(const Sight& s) { return (RightPitch(s) - LeftPitch(s)) / 2; }
double RelativeRoll(const Sight& s) { return (RightRoll(s) - LeftRoll(s)) / 2; }
double Baseline(const Sight& s) { return s.focal_px / s.depth_m; }
double RightDown(const Sight&) { return 0; }
double RightForward(const Sight& s) { return -s.focal_px * s.x_right() / s.depth_m; }
double RightFocal(const Sight& s) { return -s.x_right(); }
double LeftFocal(const Sight& s) { return s.x; }
double Focal(const Sight& s) { return LeftFocal(s) + RightFocal(s); }
double RightCx(const Sight&) { return -1; }
double LeftCx(const Sight&) { return 1; }
double Offset(const Sight&) { return 1; }
double RightK1(const Sight& s) { return -s.focal_px * Radial(s.x_right(), s.y); }
double LeftK1(const Sight& s) { return s.focal_px * Radial(s.x, s.y); }
double K1(const Sight& s) { return LeftK1(s) + RightK1(s); }
double RightP1(const Sight& s) { return -2 * s.focal_px * s.x_right() * s.y; }
double RightP2(const Sight& s) { return -s.focal_px * (3 * s.x_right() * s.x_right() + s.y * s.y); }
double AssumedFocal(const Sight& s) { return -s.baseline_m / s.depth_m; }
double AssumedBaseline(const Sight& s) { return -s.focal_px / s.depth_m; }
double Skew(const Sight& s) {
  return -s.focal_px * (s.v_mps.x() - s.x_right() * s.v_mps.z()) / s.depth_m;
}

using D = Disturbance;
constexpr DistanceLaw kLinear = DistanceLaw::kLinear, kSquare = DistanceLaw::kSquare;

constexpr std::array kTable = std::to_array<FirstOrderRow>({
    {D::kRightYaw, "yaw of the right camera", "rad", kSquare, RightYaw},
    {D::kRightPitch, "pitch of the right camera", "rad", kSquare, RightPitch},
    {D::kRightRoll, "roll of the right camera", "rad", kSquare, RightRoll},
    {D::kLeftYaw, "yaw of the left camera", "rad", kSquare, LeftYaw},
    {D::kLeftPitch, "pitch of the left camera", "rad", kSquare, LeftPitch},
    {D::kLeftRoll, "roll of the left camera", "rad", kSquare, LeftRoll},
    {D::kRelativeYaw, "relative yaw", "rad", kSquare, RelativeYaw},
    // Half of x y to each camera: x - (-x_R) nearly cancels, what is left goes with the bearing.
    {D::kRelativePitch, "relative pitch", "rad", kSquare, RelativePitch},
    {D::kRelativeRoll, "relative roll", "rad", kSquare, RelativeRoll},
    {D::kBaseline, "baseline", "m", kLinear, Baseline},
    {D::kRightDown, "right camera down", "m", DistanceLaw::kNone, RightDown},
    {D::kRightForward, "right camera forward", "m", kLinear, RightForward},
    {D::kRightFocal, "focal length of the right camera", "px", kSquare, RightFocal},
    {D::kLeftFocal, "focal length of the left camera", "px", kSquare, LeftFocal},
    {D::kFocal, "focal length", "px", kLinear, Focal},
    {D::kRightCx, "principal point of the right camera", "px", kSquare, RightCx},
    {D::kLeftCx, "principal point of the left camera", "px", kSquare, LeftCx},
    {D::kOffset, "offset of the principal points", "px", kSquare, Offset},
    {D::kRightK1, "k1 of the right camera", "1", kSquare, RightK1},
    {D::kLeftK1, "k1 of the left camera", "1", kSquare, LeftK1},
    {D::kK1, "k1", "1", kLinear, K1},
    {D::kRightP1, "p1 of the right camera", "1", kSquare, RightP1},
    {D::kRightP2, "p2 of the right camera", "1", kSquare, RightP2},
    {D::kAssumedFocal, "assumed focal length", "px", kLinear, AssumedFocal},
    {D::kAssumedBaseline, "assumed baseline", "m", kLinear, AssumedBaseline},
    {D::kSkew, "skew of the exposures", "s", kLinear, Skew},
});

constexpr bool IsInOrder() {
  for (std::size_t i = 0; i < kTable.size(); ++i) {
    if (static_cast<std::size_t>(kTable[i].disturbance) != i) return false;
  }
  return true;
}
static_assert(IsInOrder());

}  // namespace

const char* NameOf(DistanceLaw law) {
  switch (law) {
    case DistanceLaw::kConstant:
      return "const";
    case DistanceLaw::kLinear:
      return "Z";
    case DistanceLaw::kSquare:
      return "Z^2";
    case DistanceLaw::kNone:
      break;
  }
  return "0";
}

std::span<const FirstOrderRow> FirstOrderTable() { return kTable; }

const FirstOrderRow& RowOf(Disturbance disturbance) {
  return kTable[static_cast<std::size_t>(disturbance)];
}

double DepthError_m(const Sight& at, double disparity_error_px) {
  return -at.depth_m * at.depth_m / (at.focal_px * at.baseline_m) * disparity_error_px;
}

double DepthError_m(Disturbance disturbance, const Sight& at, double amount) {
  return DepthError_m(at, RowOf(disturbance).disparity_px(at) * amount);
}

double DisparitySigma_px(double left_px, double right_px, double correlation) {
  return std::sqrt(left_px * left_px + right_px * right_px - 2 * correlation * left_px * right_px);
}

double InverseDisparityBias_m(const Sight& at, double disparity_sigma_px) {
  const double relative = disparity_sigma_px / at.disparity_px();
  return at.depth_m * relative * relative;
}

double EpipolarResidual_px(const Sight& at, const Eigen::Vector3d& turn_rad,
                           const Eigen::Vector3d& shift_m) {
  const double x = at.x_right(), y = at.y;
  return at.focal_px * (turn_rad.x() * (1 + y * y) - turn_rad.z() * x - turn_rad.y() * x * y +
                        (y * shift_m.z() - shift_m.y()) / at.depth_m);
}

}  // namespace windhover
