#pragma once

#include "common/config/fields.h"

namespace windhover {

enum class EnvironmentType {
  kPlayground,
  kForest,
  kBuildings,
  kBasketballCourt,
  kPanorama,
  kPhoto
};
template <>
inline constexpr EnumNames<EnvironmentType> kEnumNames<EnvironmentType>{
    {EnvironmentType::kPlayground, "playground"},
    {EnvironmentType::kForest, "forest"},
    {EnvironmentType::kBuildings, "buildings"},
    {EnvironmentType::kBasketballCourt, "basketball_court"},
    {EnvironmentType::kPanorama, "panorama"},
    {EnvironmentType::kPhoto, "photo"}};

struct EnvironmentConfig {
  EnvironmentType type = EnvironmentType::kPlayground;
  InputFile file;
  double yaw_deg = 0;
  double photo_width_deg = 60;
  double brightness = 1;
  double sun_azimuth_deg = 120;
  double sun_elevation_deg = 50;
  double cloud_cover = 0.5;
  double visibility_m = 10000;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("type", type, AnyEnum{}, "what surrounds the aircraft, parallax-free");
    v.Field("file", file, MayBeEmpty{}, "image of type panorama (equirectangular) or photo");
    v.Field("yaw_deg", yaw_deg, InRange{-360, 360}, "turn about W's z");
    v.Field("photo_width_deg", photo_width_deg, InRange{1, 170},
            "photo: horizontal angle that it fills, centred east (plus yaw_deg)");
    v.Field("brightness", brightness, InRange{0.01, 100}, "factor on all light");
    v.Field("sun_azimuth_deg", sun_azimuth_deg, InRange{-360, 360}, "0 is east, 90 north");
    v.Field("sun_elevation_deg", sun_elevation_deg, InRange{-90, 90}, "above the horizon");
    v.Field("cloud_cover", cloud_cover, InRange{0, 1}, "0: a clear sky; 1: overcast, without sun");
    v.Field("visibility_m", visibility_m, InRange{50, 1e6},
            "meteorological: where haze leaves 2 % of a contrast");
  }
};

/// Who turns an aircraft's triangles into samples.
enum class Rasteriser { kOsMesa, kNative };
template <>
inline constexpr EnumNames<Rasteriser> kEnumNames<Rasteriser>{{Rasteriser::kOsMesa, "osmesa"},
                                                              {Rasteriser::kNative, "native"}};

struct RenderConfig {
  Rasteriser rasteriser = Rasteriser::kOsMesa;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("rasteriser", rasteriser, AnyEnum{}, "who draws aircraft: OpenGL, or our own code");
  }
};

}  // namespace windhover
