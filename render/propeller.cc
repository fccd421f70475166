#include "render/propeller.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace windhover {
namespace {

using std::numbers::pi;

// Which way the rotors turn, seen from above: against their reaction torques (sim/quadrotor.cc).
constexpr std::array kDirection = {-1, 1, -1, 1};

// Twice integrated, less its mean: 1 within `width` about every multiple of π, 0 elsewhere.
double TwiceIntegrated(double x, double width) {
  const double r = std::abs(x - pi * std::floor(x / pi + 0.5)), half = width / 2;
  const double inside = r < half ? r * r / 2 : half * (r - half / 2);
  return inside - width / pi * r * r / 2;
}

// Way of a line of sight through the slice of air, from `p_m` off the hub: out through the other
// face, or through the rim.
double WayThrough_m(const Propeller& propeller, const Eigen::Vector3d& p_m,
                    const Eigen::Vector3d& direction) {
  constexpr double kHalf_m = Propeller::kHeight_m / 2, kLevel = 1e-9;
  constexpr double kRim = 1.001;  // A vertex on the rim is inside, for all that floats can tell.
  const double to_face_m = std::max(kHalf_m + (direction.z() < 0 ? p_m.z() : -p_m.z()), 0.0) /
                           std::max(std::abs(direction.z()), kLevel);
  const double level2 = std::max(direction.head<2>().squaredNorm(), kLevel * kLevel);
  const double ahead_m = p_m.head<2>().dot(direction.head<2>()) / level2;
  const double left_m2 =
      (std::pow(kRim * propeller.radius_m, 2) - p_m.head<2>().squaredNorm()) / level2;
  const double to_rim_m = std::sqrt(std::max(ahead_m * ahead_m + left_m2, 0.0)) - ahead_m;
  return std::min(to_face_m, std::max(to_rim_m, 0.0));
}

}  // namespace

int RotorAt(float sign_x, float sign_y) {
  if (sign_x > 0) return sign_y > 0 ? 0 : 1;
  return sign_y > 0 ? 3 : 2;
}

RotorTurning RotorTurning::Part(std::size_t first, std::size_t count, std::size_t n_parts) const {
  const double n = static_cast<double>(n_parts), length = static_cast<double>(count);
  const double offset_s = duration_s * ((static_cast<double>(first) + length / 2) / n - 0.5);
  RotorTurning turning = *this;
  turning.duration_s = duration_s * (length / n);
  for (std::size_t i = 0; i < rate_hz.size(); ++i) turning.phase_rev[i] += offset_s * rate_hz[i];
  return turning;
}

double SweptShare(double angle_rad, double width_rad, double turn_rad, double spread_rad) {
  if (width_rad >= pi) return 1;
  // Two boxes, of time and of place, slide over the blade's: a second difference of what is
  // integrated twice. Below a thousandth of a radian they are as good as points.
  const double turn = std::max(std::abs(turn_rad), 1e-3), spread = std::max(spread_rad, 1e-3);
  const double far = (turn + spread) / 2, near = (turn - spread) / 2;
  const auto b = [&](double x) { return TwiceIntegrated(x, width_rad); };
  const double share = width_rad / pi + (b(angle_rad + far) - b(angle_rad + near) -
                                         b(angle_rad - near) + b(angle_rad - far)) /
                                            (turn * spread);
  return std::clamp(share, 0.0, 1.0);
}

// A line of sight that comes down through the slice from (s_in, z_in) to (s_out, z_out), s ahead of
// the middle of a blade's chord c, meets the blade z = h s / c if s_in < c z_in / h and
// s_out > c z_out / h, or neither holds. So blades between c (z_in + z_out) / 2h behind the middle
// of the line and ahead of it hide it, as far as c (z_in - z_out) / h + s_out - s_in reaches.
double BladeCoverage(const Propeller& propeller, const RotorTurning& turning,
                     const Eigen::Vector3d& p_B_m, const Eigen::Vector3d& direction_B,
                     double spread_rad) {
  const Eigen::Vector3d in_m = p_B_m - propeller.hub_m.cast<double>();
  const Eigen::Vector3d out_m = in_m + WayThrough_m(propeller, in_m, direction_B) * direction_B;
  const auto rotor = static_cast<std::size_t>(propeller.rotor);
  const double ahead = kDirection[rotor];
  const double span_rad =
      std::atan2(in_m.x() * out_m.y() - in_m.y() * out_m.x(), in_m.head<2>().dot(out_m.head<2>()));
  const double middle_rad = std::atan2(in_m.y(), in_m.x()) + span_rad / 2;
  const double r_m = std::max((in_m + out_m).head<2>().norm() / 2, 0.05 * propeller.radius_m);
  const double chord_rad = propeller.Chord_m(r_m) / r_m;
  const double down = (in_m.z() - out_m.z()) / Propeller::kHeight_m;
  const double above = (in_m.z() + out_m.z()) / (2 * Propeller::kHeight_m);
  const double blade_rad = ahead * (2 * pi * turning.phase_rev[rotor] + above * chord_rad);
  return SweptShare(middle_rad - blade_rad, std::abs(chord_rad * down + ahead * span_rad),
                    2 * pi * turning.rate_hz[rotor] * turning.duration_s, spread_rad);
}

}  // namespace windhover
