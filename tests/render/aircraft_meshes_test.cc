#include "render/aircraft_meshes.h"

#include <cmath>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/mesh_builder.h"
#include "render/random_meshes.h"

namespace windhover {
namespace {

constexpr float kTolerance_m = 1e-3f;  // Dimensions are published in whole millimetres.

Eigen::AlignedBox3f WholeBox(const AircraftModel& model) {
  return BoundingBox(model.body).merged(BoundingBox(model.rotor_discs));
}

// Vertices at the same place are one point, whichever part of the surface they belong to.
using PointKey = std::tuple<std::int64_t, std::int64_t, std::int64_t>;
PointKey KeyOf(const Eigen::Vector3f& p) {
  constexpr double kGrid_m = 1e-6;
  return {std::llround(p.x() / kGrid_m), std::llround(p.y() / kGrid_m),
          std::llround(p.z() / kGrid_m)};
}

// How many edges are not passed exactly as often in one direction as in the other.
int CountOpenEdges(const Mesh& mesh) {
  std::map<std::pair<PointKey, PointKey>, int> balance;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const PointKey a = KeyOf(mesh.positions[t[i]]), b = KeyOf(mesh.positions[t[(i + 1) % 3]]);
      if (a != b) balance[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  return static_cast<int>(
      std::count_if(balance.begin(), balance.end(), [](const auto& e) { return e.second != 0; }));
}

// Six times the signed volume is positive where triangles face outward.
double SignedVolume_m3(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.positions[t[0]].cast<double>(),
                          b = mesh.positions[t[1]].cast<double>(),
                          c = mesh.positions[t[2]].cast<double>();
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

int CountNormalsAgainstWinding(const Mesh& mesh) {
  int count = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f &a = mesh.positions[t[0]], &b = mesh.positions[t[1]],
                          &c = mesh.positions[t[2]];
    const Eigen::Vector3f facing = (b - a).cross(c - a);
    for (const std::uint32_t v : t) count += mesh.normals[v].dot(facing) < 0;
  }
  return count;
}

// V7.1; V7.4: the middle of the box is the origin of B, which ranges and labels refer to.
TEST(M200, HasThePublishedDimensions) {
  const Eigen::AlignedBox3f box = WholeBox(MakeM200(true));
  EXPECT_NEAR(box.sizes().x(), 0.887f, kTolerance_m);
  EXPECT_NEAR(box.sizes().y(), 0.880f, kTolerance_m);
  EXPECT_NEAR(box.sizes().z(), 0.378f, kTolerance_m);
  EXPECT_LT(box.center().norm(), kTolerance_m);
}

// V7.1, V7.4.
TEST(P600, HasTheMeasuredDimensions) {
  const AircraftModel p600 = MakeP600();
  const Eigen::AlignedBox3f body = BoundingBox(p600.body), discs = BoundingBox(p600.rotor_discs);
  EXPECT_NEAR(body.sizes().x(), 0.470f, kTolerance_m);
  EXPECT_NEAR(body.sizes().y(), 0.470f, kTolerance_m);
  EXPECT_NEAR(body.sizes().z(), 0.392f, kTolerance_m);
  EXPECT_NEAR(discs.sizes().x(), 2 * 0.2121f + 0.388f, kTolerance_m);
  EXPECT_NEAR(discs.sizes().y(), 2 * 0.2121f + 0.388f, kTolerance_m);
  EXPECT_LT(WholeBox(p600).center().norm(), kTolerance_m);
}

TEST(UnseenAircraft, HaveTheirDimensions) {
  const Eigen::AlignedBox3f hexacopter = WholeBox(MakeHexacopter()),
                            wing = WholeBox(MakeFlyingWing());
  // Two of six arms lie along y; those beside x are 30 degrees off it.
  EXPECT_NEAR(hexacopter.sizes().y(), 0.550f + 0.254f, kTolerance_m);
  EXPECT_NEAR(hexacopter.sizes().x(), 0.550f * 0.8660f + 0.254f, kTolerance_m);
  EXPECT_NEAR(wing.sizes().y(), 0.860f, kTolerance_m);
  for (const AircraftModel& model : {MakeHexacopter(), MakeFlyingWing()}) {
    EXPECT_LT(WholeBox(model).center().norm(), kTolerance_m);
    EXPECT_EQ(CountOpenEdges(model.body), 0);
    EXPECT_EQ(CountNormalsAgainstWinding(model.body), 0);
    EXPECT_GT(SignedVolume_m3(model.body), 1e-3);
  }
}

class OwnModel : public testing::TestWithParam<AircraftType> {
 protected:
  static Aircraft OfType(AircraftType type) {
    Aircraft aircraft;
    aircraft.type = type;
    return aircraft;
  }
  const AircraftModel model_ = MakeAircraftModel(OfType(GetParam()));
};

// V7.2.
TEST_P(OwnModel, IsWatertight) { EXPECT_EQ(CountOpenEdges(model_.body), 0); }

TEST_P(OwnModel, StaysWatertightWithShortEdges) {
  const Mesh fine = WithShortEdges(model_.body, 0.02f);
  EXPECT_EQ(CountOpenEdges(fine), 0);
  EXPECT_NEAR(SignedVolume_m3(fine), SignedVolume_m3(model_.body), 1e-7);
  for (const auto& t : fine.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_LE((fine.positions[t[i]] - fine.positions[t[(i + 1) % 3]]).norm(), 0.02f + 1e-6f);
    }
  }
}

// V7.2.
TEST_P(OwnModel, FacesOutward) {
  EXPECT_GT(SignedVolume_m3(model_.body), 1e-3);
  EXPECT_EQ(CountNormalsAgainstWinding(model_.body), 0);
}

TEST_P(OwnModel, IsLight) { EXPECT_LE(model_.body.triangles.size(), 10'000u); }

TEST_P(OwnModel, IsInRange) {
  for (std::size_t i = 0; i < model_.body.positions.size(); ++i) {
    ASSERT_NEAR(model_.body.normals[i].norm(), 1, 1e-5);
    ASSERT_TRUE((model_.body.base_colours[i].array() >= 0).all());
    ASSERT_TRUE((model_.body.base_colours[i].array() <= 1).all());
  }
}

INSTANTIATE_TEST_SUITE_P(All, OwnModel,
                         testing::Values(AircraftType::kM200Orange, AircraftType::kM200Black,
                                         AircraftType::kP600));

/// Drawings that no two look alike, and how large they may be.
struct RandomKind {
  const char* name;
  AircraftModel (*make)(RandomStream*);
  float least_m, most_m;  ///< Longest side.
};

class RandomModel : public testing::TestWithParam<RandomKind> {};

TEST_P(RandomModel, IsClosedAndOfItsSize) {
  RandomStream random(1, GetParam().name);
  float least_m = 1e9f, most_m = 0;
  for (int i = 0; i < 40; ++i) {
    const AircraftModel model = GetParam().make(&random);
    EXPECT_EQ(CountOpenEdges(model.body), 0);
    EXPECT_EQ(CountNormalsAgainstWinding(model.body), 0);
    EXPECT_GT(SignedVolume_m3(model.body), 0);
    EXPECT_LE(model.body.triangles.size(), 20'000u);
    EXPECT_LT(WholeBox(model).center().norm(), 1e-4f);
    for (const Eigen::Vector3f& colour : model.body.base_colours) {
      ASSERT_TRUE((colour.array() >= 0).all() && (colour.array() <= 1).all());
    }
    least_m = std::min(least_m, WholeBox(model).sizes().maxCoeff());
    most_m = std::max(most_m, WholeBox(model).sizes().maxCoeff());
  }
  EXPECT_GE(least_m, GetParam().least_m);
  EXPECT_LE(most_m, GetParam().most_m);
  EXPECT_GT(most_m, 1.3f * least_m);  // They do differ.
}

INSTANTIATE_TEST_SUITE_P(All, RandomModel,
                         testing::Values(RandomKind{"quadrotor", MakeRandomQuadrotor, 0.2f, 1.8f},
                                         RandomKind{"bird", MakeRandomBird, 0.2f, 2.6f},
                                         RandomKind{"aeroplane", MakeRandomAeroplane, 0.6f, 12.5f},
                                         RandomKind{"tree", MakeRandomTree, 1.5f, 9.f},
                                         RandomKind{"clutter", MakeRandomClutter, 0.02f, 3.5f}),
                         [](const auto& kind) { return kind.param.name; });

TEST(MakeRandomQuadrotor, HasPropellersThatPassEachOther) {
  RandomStream random(2, "quadrotor");
  for (int i = 0; i < 40; ++i) {
    const AircraftModel model = MakeRandomQuadrotor(&random);
    ASSERT_EQ(model.propellers.size(), 4u);
    for (const Propeller& a : model.propellers) {
      for (const Propeller& b : model.propellers) {
        if (a.rotor == b.rotor) continue;
        EXPECT_GT((a.hub_m - b.hub_m).norm(), a.radius_m + b.radius_m);
      }
    }
  }
}

TEST(AddRoundedBox, HasTheVolumeOfTheFormula) {
  Mesh mesh;
  AddRoundedBox({1, 2, 3}, {0.4f, 0.3f, 0.2f}, 0.05f, {1, 1, 1}, &mesh);
  // Box of the inner size grown by r: V = abc + 2r(ab+bc+ca) + πr²(a+b+c) + 4/3πr³.
  const double a = 0.3, b = 0.2, c = 0.1, r = 0.05;
  const double exact = a * b * c + 2 * r * (a * b + b * c + c * a) + M_PI * r * r * (a + b + c) +
                       4.0 / 3 * M_PI * r * r * r;
  // Two facets a quarter circle lose 1 - sin(45°)/(45° in rad) of its area: 2.6 % of π r² here.
  EXPECT_NEAR(SignedVolume_m3(mesh), exact, 0.1 * M_PI * r * r * (a + b + c));
  EXPECT_LT(SignedVolume_m3(mesh), exact);
}

TEST(CountOpenEdges, FindsAHole) {
  Mesh mesh;
  AddEllipsoid({0, 0, 0}, {1, 1, 1}, 8, {1, 1, 1}, &mesh);
  ASSERT_EQ(CountOpenEdges(mesh), 0);
  mesh.triangles.pop_back();
  EXPECT_EQ(CountOpenEdges(mesh), 3);
}

TEST(ExtremeVertices, BoundsEveryDirection) {
  const Mesh mesh = MakeM200(true).body;
  const std::vector<std::uint32_t> extreme = ExtremeVertices(mesh.positions);
  EXPECT_LT(extreme.size(), 400u);
  for (const Eigen::Vector3f& d : SphereDirections(777)) {
    float all = -1e9f, few = -1e9f;
    for (const Eigen::Vector3f& p : mesh.positions) all = std::max(all, p.dot(d));
    for (const std::uint32_t i : extreme) few = std::max(few, mesh.positions[i].dot(d));
    EXPECT_NEAR(all, few, 1e-3f);
  }
}

}  // namespace
}  // namespace windhover
