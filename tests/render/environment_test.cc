#include "render/environment.h"

#include <array>
#include <cmath>
#include <fstream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "common/cpu/instruction_set.h"
#include "render/haze.h"
#include "render/procedural_noise.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

using testing::HasSubstr;

constexpr float kFootprint_rad = 1e-3f;

EnvironmentConfig OfType(EnvironmentType type) {
  EnvironmentConfig config;
  config.type = type;
  return config;
}

class Procedural : public testing::TestWithParam<EnvironmentType> {};

TEST_P(Procedural, IsFiniteAndInRangeAllAround) {
  const auto environment = MakeEnvironment(OfType(GetParam()));
  for (int elevation = -90; elevation <= 90; elevation += 3) {
    for (int azimuth = -180; azimuth <= 180; azimuth += 5) {
      const Eigen::Vector3f light =
          environment->Radiance(DirectionFromAngles(azimuth, elevation), kFootprint_rad);
      ASSERT_TRUE(light.allFinite()) << azimuth << ' ' << elevation;
      ASSERT_GE(light.minCoeff(), 0);
      ASSERT_LE(light.maxCoeff(), 5);
    }
  }
}

TEST_P(Procedural, HasNoSeamInTheWest) {
  const auto environment = MakeEnvironment(OfType(GetParam()));
  // Neighbouring directions differ no more across azimuth ±180° than elsewhere, on average.
  const auto step = [&](double azimuth_deg) {
    double sum = 0;
    for (int i = 0; i < 400; ++i) {
      const double elevation_deg = -10 + 0.05 * i;
      sum += (environment->Radiance(DirectionFromAngles(azimuth_deg - 0.01, elevation_deg), 1e-2f) -
              environment->Radiance(DirectionFromAngles(azimuth_deg + 0.01, elevation_deg), 1e-2f))
                 .norm();
    }
    return sum / 400;
  };
  double elsewhere = 0;
  for (int azimuth = -170; azimuth < 180; azimuth += 10)
    elsewhere = std::max(elsewhere, step(azimuth));
  EXPECT_LE(step(180), elsewhere + 1e-3);
}

TEST_P(Procedural, LightsFromAbove) {
  const EnvironmentConfig config = OfType(GetParam());
  const auto environment = MakeEnvironment(config);
  const SkyLight light(config, *environment);
  EXPECT_GT(light.AmbientRadiance({0, 0, 1}).mean(), light.AmbientRadiance({0, 0, -1}).mean());
  EXPECT_GT(light.SunRadiance().mean(), 0.05f);
}

// Directions of one tile at a time leave out what the tile cannot show: that changes no bit.
TEST_P(Procedural, IsTheSameTogetherAsAlone) {
  const auto environment = MakeEnvironment(OfType(GetParam()));
  constexpr double kStep_deg = 0.17;
  for (int elevation = -40; elevation <= 60; elevation += 4) {
    for (int azimuth = -180; azimuth < 180; azimuth += 7) {
      std::vector<Eigen::Vector3f> d_W;
      for (int i = 0; i < 64; ++i) {
        d_W.push_back(
            DirectionFromAngles(azimuth + i % 8 * kStep_deg, elevation + i / 8 * kStep_deg));
      }
      std::vector<Eigen::Vector3f> light(d_W.size());
      environment->FillRadiance(d_W, kFootprint_rad, light);
      for (std::size_t i = 0; i < d_W.size(); ++i) {
        ASSERT_EQ(light[i], environment->Radiance(d_W[i], kFootprint_rad)) << azimuth << elevation;
      }
    }
  }
}

TEST_P(Procedural, IsFiniteInAnyWeatherAtAnyHour) {
  for (const double cloud_cover : {0.0, 0.3, 0.5, 0.8, 1.0}) {
    for (const double sun_deg : {-90.0, -8.0, -3.0, 0.0, 5.0, 9.0, 50.0, 90.0}) {
      for (const double visibility_m : {50.0, 1e4, 1e6}) {
        EnvironmentConfig config = OfType(GetParam());
        config.cloud_cover = cloud_cover;
        config.sun_elevation_deg = sun_deg;
        config.visibility_m = visibility_m;
        const auto environment = MakeEnvironment(config);
        const SkyLight light(config, *environment);
        ASSERT_TRUE(light.SunRadiance().allFinite());
        ASSERT_GE(light.SunRadiance().minCoeff(), 0);
        for (int elevation = -90; elevation <= 90; elevation += 15) {
          for (int azimuth = -180; azimuth <= 180; azimuth += 20) {
            const Eigen::Vector3f d_W = DirectionFromAngles(azimuth, elevation);
            ASSERT_TRUE(environment->Radiance(d_W, kFootprint_rad).allFinite());
            ASSERT_GE(environment->Radiance(d_W, kFootprint_rad).minCoeff(), 0);
            ASSERT_GE(environment->AirLight(d_W).minCoeff(), 0);
          }
        }
      }
    }
  }
}

// At 50 m of visibility nothing of a scene's rings, all beyond 90 m, has a thousandth of its
// contrast left: 0.02^(90/50) = 9e-4. (Forest and court begin nearer.)
TEST(Weather, FogHidesAllThatIsFar) {
  EnvironmentConfig config = OfType(EnvironmentType::kPlayground);
  config.visibility_m = 50;
  const auto environment = MakeEnvironment(config);
  for (int azimuth = -180; azimuth < 180; azimuth += 5) {
    const Eigen::Vector3f d_W = DirectionFromAngles(azimuth, 1);
    EXPECT_LT((environment->Radiance(d_W, kFootprint_rad) - environment->AirLight(d_W)).norm(),
              1e-3f);
  }
}

TEST(Weather, AnOvercastSkyHasNoSun) {
  EnvironmentConfig config = OfType(EnvironmentType::kPlayground);
  const Eigen::Vector3f to_sun =
      DirectionFromAngles(config.sun_azimuth_deg, config.sun_elevation_deg);
  const Eigen::Vector3f beside =
      DirectionFromAngles(config.sun_azimuth_deg + 5, config.sun_elevation_deg);
  const auto clear = MakeEnvironment(config);
  EXPECT_GT(clear->Radiance(to_sun, kFootprint_rad).minCoeff(), 3);
  config.cloud_cover = 1;
  const auto overcast = MakeEnvironment(config);
  const SkyLight light(config, *overcast);
  EXPECT_EQ(light.SunRadiance().maxCoeff(), 0);
  // Clouds differ by a fifth at most.
  EXPECT_NEAR(overcast->Radiance(to_sun, kFootprint_rad).mean() /
                  overcast->Radiance(beside, kFootprint_rad).mean(),
              1, 0.2);
  const Eigen::Vector3f sky = overcast->Radiance({0, 0, 1}, kFootprint_rad);
  EXPECT_LT(sky.maxCoeff() / sky.minCoeff(), 1.15f);  // Grey.
}

TEST(Weather, TheSunFadesAndReddensAsItSets) {
  EnvironmentConfig config = OfType(EnvironmentType::kBuildings);
  float brightest = 0, reddest = 1e9f;
  for (const double sun_deg : {0.5, 2.0, 4.0, 7.0, 10.0}) {
    config.sun_elevation_deg = sun_deg;
    const SkyLight light(config, *MakeEnvironment(config));
    EXPECT_GT(light.SunRadiance().mean(), brightest) << sun_deg;
    EXPECT_LT(light.SunRadiance().x() / light.SunRadiance().z(), reddest) << sun_deg;
    brightest = light.SunRadiance().mean();
    reddest = light.SunRadiance().x() / light.SunRadiance().z();
  }
  config.sun_elevation_deg = -1;
  EXPECT_EQ(SkyLight(config, *MakeEnvironment(config)).SunRadiance().maxCoeff(), 0);
}

TEST(Weather, DuskIsWarmTowardsTheSunAndBlueHourIsDim) {
  EnvironmentConfig config = OfType(EnvironmentType::kPlayground);
  config.cloud_cover = 0;
  config.sun_elevation_deg = 1;
  const auto dusk = MakeEnvironment(config);
  const auto warmth = [&](const Environment& environment, double azimuth_deg) {
    const Eigen::Vector3f sky =
        environment.Radiance(DirectionFromAngles(azimuth_deg, 15), kFootprint_rad);
    return sky.x() / sky.z();
  };
  EXPECT_GT(warmth(*dusk, config.sun_azimuth_deg), 1.2f);
  EXPECT_GT(warmth(*dusk, config.sun_azimuth_deg),
            1.3f * warmth(*dusk, config.sun_azimuth_deg + 180));
  const Eigen::Vector3f up(0, 0, 1);
  const float dusk_light = SkyLight(config, *dusk).AmbientRadiance(up).mean();
  config.sun_elevation_deg = -8;
  const auto night = MakeEnvironment(config);
  const float night_light = SkyLight(config, *night).AmbientRadiance(up).mean();
  EXPECT_LT(night_light, 0.6f * dusk_light);
  EXPECT_GT(night_light, 0.03f);  // A picture still shows something.
}

// Eight octaves at a time give the bits of one after the other.
TEST(ProceduralNoise, IsTheSameWithAndWithoutAvx2) {
  if (WidestInstructionSet() < InstructionSet::kAvx2) GTEST_SKIP() << "no AVX2";
  for (int i = 0; i < 20000; ++i) {
    const float x = 3000 * (CellHash(i, 0, 1) - 0.5f), y = 300 * (CellHash(i, 1, 1) - 0.5f);
    const float footprint = std::pow(10.0f, -3 * CellHash(i, 2, 1));
    const auto seed = static_cast<std::uint32_t>(1e6f * CellHash(i, 3, 1));
    NoiseOctaves one, eight;
    NoiseOctavesScalar(x, y, kMaxOctaves, footprint, seed, &one);
    NoiseOctavesAvx2(x, y, footprint, seed, &eight);
    for (std::size_t k = 0; k < kMaxOctaves; ++k) {
      ASSERT_EQ(one.fade[k], eight.fade[k]) << i;
      if (one.fade[k] <= 0) break;
      ASSERT_EQ(one.noise[k], eight.noise[k]) << x << ' ' << y << ' ' << seed;
    }
  }
}

TEST(Haze, LeavesTwoPercentAtTheVisibility) {
  const Haze haze(800);
  EXPECT_NEAR(haze.Clear(800), 0.02f, 1e-6f);
  EXPECT_NEAR(haze.Clear(400), std::sqrt(0.02f), 1e-6f);
  EXPECT_EQ(haze.Clear(0), 1);
  const Eigen::Vector3f air(0.5f, 0.6f, 0.7f);
  EXPECT_TRUE(haze.Through({0, 0, 0}, air, 800).isApprox(0.98f * air, 1e-5f));
  std::array lights = {Eigen::Vector3f(1, 1, 1), Eigen::Vector3f(0, 0, 0)};
  haze.Veil(air, 400, lights);
  EXPECT_NEAR((lights[0] - lights[1]).x(), std::sqrt(0.02f), 1e-6f);
}

INSTANTIATE_TEST_SUITE_P(All, Procedural,
                         testing::Values(EnvironmentType::kPlayground, EnvironmentType::kForest,
                                         EnvironmentType::kBuildings,
                                         EnvironmentType::kBasketballCourt));

// A uniform surrounding of radiance L lights a white surface of any normal to radiance L.
TEST(SkyLight, OfAUniformWorldIsItsRadiance) {
  struct Uniform : Environment {
    Eigen::Vector3f Radiance(const Eigen::Vector3f&, float) const override {
      return {0.2f, 0.3f, 0.4f};
    }
  };
  const SkyLight light(EnvironmentConfig{}, Uniform());
  for (const Eigen::Vector3f& n : {Eigen::Vector3f(0, 0, 1), Eigen::Vector3f(0.6f, 0, -0.8f)}) {
    EXPECT_TRUE(light.AmbientRadiance(n).isApprox(Eigen::Vector3f(0.2f, 0.3f, 0.4f), 0.01f));
  }
}

class ImageEnvironment : public testing::Test {
 protected:
  // Left half red, right half green; top quarter blue.
  EnvironmentConfig WithImage(EnvironmentType type, int width, int height, const char* name) const {
    cv::Mat image(height, width, CV_8UC3, cv::Scalar(0, 255, 0));
    image(cv::Rect(0, 0, width / 2, height)).setTo(cv::Scalar(0, 0, 255));
    image(cv::Rect(0, 0, width, height / 4)).setTo(cv::Scalar(255, 0, 0));
    cv::imwrite((folder_.path() / name).string(), image);
    return Named(type, name);
  }
  EnvironmentConfig Named(EnvironmentType type, const std::string& name) const {
    EnvironmentConfig config = OfType(type);
    config.file = {
        .as_given = name, .absolute = (folder_.path() / name).string(), .where = "s.yaml:3:4"};
    return config;
  }
  static std::string ErrorOf(const EnvironmentConfig& config) {
    try {
      MakeEnvironment(config);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "no error";
  }
  TemporaryFolder folder_;
};

void ExpectColour(const Environment& environment, double azimuth_deg, double elevation_deg,
                  const Eigen::Vector3f& colour) {
  const Eigen::Vector3f light =
      environment.Radiance(DirectionFromAngles(azimuth_deg, elevation_deg), kFootprint_rad);
  EXPECT_TRUE(light.isApprox(colour, 1e-3f)) << light.transpose();
}

TEST_F(ImageEnvironment, PanoramaHasItsLeftHalfInTheNorth) {
  const auto panorama = MakeEnvironment(WithImage(EnvironmentType::kPanorama, 512, 256, "p.png"));
  ExpectColour(*panorama, 90, 0, {1, 0, 0});
  ExpectColour(*panorama, -90, 0, {0, 1, 0});
  ExpectColour(*panorama, 10, 80, {0, 0, 1});
}

TEST_F(ImageEnvironment, PhotoFillsItsWidthAboutEastAndIsMirroredOutside) {
  EnvironmentConfig config = WithImage(EnvironmentType::kPhoto, 400, 300, "p.png");
  config.photo_width_deg = 60;
  const auto photo = MakeEnvironment(config);
  ExpectColour(*photo, 20, 0, {1, 0, 0});
  ExpectColour(*photo, -20, 0, {0, 1, 0});
  ExpectColour(*photo, 40, 0, {1, 0, 0});    // Mirrored at 30°.
  ExpectColour(*photo, 0.5, 18, {0, 0, 1});  // 45° high in all; the upper quarter is above 11°.
}

TEST_F(ImageEnvironment, TurnsByYaw) {
  EnvironmentConfig config = WithImage(EnvironmentType::kPanorama, 512, 256, "p.png");
  config.yaw_deg = 180;
  ExpectColour(*MakeEnvironment(config), -90, 0, {1, 0, 0});
}

TEST_F(ImageEnvironment, NamesWhatIsWrongWithAFile) {
  const auto panorama = EnvironmentType::kPanorama;
  EXPECT_EQ(ErrorOf(Named(panorama, "no.png")), "s.yaml:3:4: no such image file (found 'no.png')");
  std::ofstream(folder_.path() / "empty.png").close();
  EXPECT_THAT(ErrorOf(Named(panorama, "empty.png")), HasSubstr("is empty"));
  for (const char* name : {"bad.png", "bad.jpg", "bad.hdr", "bad.exr"}) {
    std::ofstream(folder_.path() / name) << "#?RADIANCE this is no image";
    EXPECT_THAT(ErrorOf(Named(panorama, name)), HasSubstr("s.yaml:3:4: ")) << name;
  }
  EXPECT_THAT(ErrorOf(WithImage(panorama, 300, 300, "square.png")), HasSubstr("twice as wide"));
}

TEST(RealImages, AreExposedToMidGrey) {
  const std::filesystem::path folder =
      std::filesystem::path(WINDHOVER_REAL_INPUTS_DIR) / "environments";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no real inputs beside the repository";
  for (const char* name : {"forest.exr", "courtyard.exr", "home_office_1024x512.hdr"}) {
    EnvironmentConfig config = OfType(EnvironmentType::kPanorama);
    config.file = {.as_given = name, .absolute = (folder / name).string(), .where = "s.yaml:1:1"};
    const auto environment = MakeEnvironment(config);
    const SkyLight light(config, *environment);
    const float mean = light.AmbientRadiance({0, 0, 1}).mean();
    EXPECT_GT(mean, 0.05f) << name;
    EXPECT_LT(mean, 0.9f) << name;
  }
}

}  // namespace
}  // namespace windhover
