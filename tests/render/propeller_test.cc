#include "render/propeller.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "common/geometry/rotation.h"

namespace windhover {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

// Places and sizes of meshes are floats.
constexpr double kFloat = 1e-6;

const Propeller kPropeller{.hub_m = {0.2f, 0.2f, 0.1f}, .radius_m = 0.2f, .rotor = 3};
const Vector3d kDown(0, 0, -1);
const Vector3d kTop(0.2, 0.2, 0.106);

RotorTurning Turning(double phase_rev, double turns) {
  return {.phase_rev = {0, 0, 0, phase_rev}, .rate_hz = {0, 0, 0, 100}, .duration_s = turns / 100};
}

Vector3d Polar(double r_m, double angle_rad) {
  return kTop + Vector3d(r_m * std::cos(angle_rad), r_m * std::sin(angle_rad), 0);
}

// Of a turn in 10 ms about 0.5, the first half is at 0.25, and lasts 5 ms.
TEST(Propeller, TurnsOnFromPartToPart) {
  const RotorTurning first = Turning(0.5, 1).Part(0, 1, 2), last = Turning(0.5, 1).Part(1, 1, 2);
  EXPECT_NEAR(first.phase_rev[3], 0.25, 1e-12);
  EXPECT_NEAR(last.phase_rev[3], 0.75, 1e-12);
  EXPECT_NEAR(first.duration_s, 0.005, 1e-15);
  EXPECT_EQ(first.rate_hz[3], 100);
}

// Seen along its axis, a propeller at rest is its blades: rotor 3 turns counter-clockwise.
TEST(Propeller, AtRestIsItsBlades) {
  const auto at = [](double phase_rev, double angle_rad) {
    return BladeCoverage(kPropeller, Turning(phase_rev, 0), Polar(0.1, angle_rad), kDown, 0);
  };
  EXPECT_NEAR(at(0, 0), 1, kFloat);
  EXPECT_NEAR(at(0, pi), 1, kFloat);
  EXPECT_NEAR(at(0, pi / 2), 0, kFloat);
  EXPECT_NEAR(at(0.25, pi / 2), 1, kFloat);
  EXPECT_NEAR(at(0.125, pi / 4), 1, kFloat);  // -1/8 turn would be at -45 degrees.
  EXPECT_NEAR(at(0.125, -pi / 4), 0, kFloat);
  // 0.026 m of chord at half the radius are ±0.13 rad.
  EXPECT_NEAR(at(0, 0.129), 1, kFloat);
  EXPECT_NEAR(at(0, 0.131), 0, kFloat);
}

// At 2 ms and 50 turns a second blades sweep 36 degrees: a place that one passes wholly is hidden
// for as long as the chord's angle lasts.
TEST(Propeller, SweepsForAsLongAsItsChord) {
  const double chord_rad = kPropeller.Chord_m(0.1) / 0.1, swept_rad = pi / 5;
  const auto at = [](double angle_rad) {
    return BladeCoverage(kPropeller, Turning(0, 0.1), Polar(0.1, angle_rad), kDown, 0);
  };
  EXPECT_NEAR(at(0), chord_rad / swept_rad, 1e-6);
  EXPECT_NEAR(at(0.15), chord_rad / swept_rad, 1e-6);
  EXPECT_NEAR(at(swept_rad / 2), chord_rad / swept_rad / 2, 1e-3);  // Half of it passes.
  EXPECT_NEAR(at(0.6), 0, kFloat);
}

TEST(Propeller, HalfATurnIsEvenAllAround) {
  for (const double r_m : {0.04, 0.1, 0.2}) {
    for (const double angle_rad : {0.0, 1.0, 2.5, 4.0}) {
      EXPECT_NEAR(BladeCoverage(kPropeller, Turning(0.3, 0.5), Polar(r_m, angle_rad), kDown, 0.1),
                  kPropeller.Chord_m(r_m) / r_m / pi, kFloat);
    }
  }
}

// Mean by counting, to its step of 1/400 of each interval and the jump at an edge.
TEST(Propeller, SweptShareIsTheMeanOverTimeAndPlace) {
  constexpr int kSteps = 400;
  for (const double angle : {-2.0, -0.2, 0.0, 0.3, 1.4, 7.0}) {
    for (const double width : {0.1, 0.8, 2.5}) {
      for (const double turn : {0.05, 0.6, 2.0, 5.0}) {
        for (const double spread : {0.02, 0.13, 0.5}) {
          double sum = 0;
          for (int i = 0; i < kSteps; ++i) {
            for (int j = 0; j < kSteps; ++j) {
              const double at =
                  angle + turn * ((i + 0.5) / kSteps - 0.5) + spread * ((j + 0.5) / kSteps - 0.5);
              sum += std::abs(std::remainder(at, pi)) < width / 2;
            }
          }
          EXPECT_NEAR(SweptShare(angle, width, turn, spread), sum / (kSteps * kSteps), 3e-3);
        }
      }
    }
  }
}

// Level lines of sight: half a turn's mean is the share of blade directions that point at the
// line's chord through the disc, arccos(x / R) · 2 / π.
TEST(Propeller, FromTheSideIsItsSpan) {
  for (const double x_m : {0.05, 0.1, 0.15}) {
    const double y_m = std::sqrt(0.04 - x_m * x_m);
    const Vector3d entry = Vector3d(0.2, 0.2, 0.1) + Vector3d(x_m, -y_m, 0);
    const double share = BladeCoverage(kPropeller, Turning(0, 0.5), entry, Vector3d::UnitY(), 0.1);
    const double span_rad = 2 * std::acos(x_m / 0.2f);
    EXPECT_NEAR(share, span_rad / pi, 2e-3) << x_m;
  }
}

// A line of sight meets the pitched sheet of a blade, from its upper leading edge to its lower
// trailing edge, or not: counted over all directions of the blades.
bool IsHidden(const Vector3d& from_m, const Vector3d& direction, double blade_rad) {
  constexpr int kSteps = 300;
  const double way_m = Propeller::kHeight_m / std::max(std::abs(direction.z()), kFloat);
  double before = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const Vector3d p = from_m + direction * (way_m * i / kSteps);
    const double along = p.x() * std::cos(blade_rad) + p.y() * std::sin(blade_rad);
    const double across = p.y() * std::cos(blade_rad) - p.x() * std::sin(blade_rad);
    const double r_m = std::abs(along), ahead = along > 0 ? across : -across;
    if (r_m > kPropeller.radius_m) continue;
    const double chord_m = kPropeller.Chord_m(r_m);
    const double above = p.z() - Propeller::kHeight_m * ahead / chord_m;
    if (i > 0 && std::abs(ahead) < chord_m / 2 && above * before <= 0) return true;
    before = above;
  }
  return false;
}

class Elevation : public testing::TestWithParam<double> {};

// What blades hide of the disc as a whole, from 3 to 90 degrees above it.
TEST_P(Elevation, HidesAsMuchAsPitchedBladesDo) {
  const double elevation_rad = RadFromDeg(GetParam());
  const Vector3d direction(std::cos(elevation_rad), 0, -std::sin(elevation_rad));
  double counted = 0, closed = 0;
  for (double x = -0.19; x < 0.2; x += 0.02) {
    for (double y = -0.19; y < 0.2; y += 0.02) {
      if (std::hypot(x, y) > 0.19 || std::hypot(x, y) < 0.02) continue;
      const Vector3d from(x, y, 0.006);
      constexpr int kBlades = 180;
      for (int i = 0; i < kBlades; ++i) {
        counted += IsHidden(from, direction, pi * (i + 0.5) / kBlades) ? 1.0 / kBlades : 0;
      }
      closed += BladeCoverage(kPropeller, Turning(0, 0.5), Vector3d(0.2, 0.2, 0.1) + from,
                              direction, 0.1);
    }
  }
  // Blades taper, and a line of sight has one chord here: up to 6 % at 12 degrees.
  EXPECT_NEAR(closed / counted, 1, 0.07);
}

INSTANTIATE_TEST_SUITE_P(Views, Elevation, testing::Values(3.0, 6.0, 12.0, 25.0, 50.0, 90.0));

}  // namespace
}  // namespace windhover
