#pragma once

#include "camera/any_camera.h"
#include "common/config/fields.h"

namespace windhover {

enum class LensModel { kRadtan, kRational, kThinPrism, kKannalaBrandt };
template <>
inline constexpr EnumNames<LensModel> kEnumNames<LensModel>{
    {LensModel::kRadtan, "radtan"},
    {LensModel::kRational, "rational"},
    {LensModel::kThinPrism, "thin_prism"},
    {LensModel::kKannalaBrandt, "kannala_brandt"}};

/// Which camera model, and its terms in OpenCV's meaning: radtan has k1, k2, p1, p2, k3; rational
/// also k4, k5, k6; thin_prism also s1 to s4; kannala_brandt has k1 to k4.
struct LensConfig {
  LensModel model = LensModel::kRadtan;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0, k4 = 0, k5 = 0, k6 = 0;
  double s1 = 0, s2 = 0, s3 = 0, s4 = 0;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("model", model, AnyEnum{}, "which terms there are");
    v.Field("k1", k1, InRange{-100, 100}, "first radial term");
    v.Field("k2", k2, InRange{-1000, 1000}, "second radial term");
    v.Field("p1", p1, InRange{-0.1, 0.1}, "first tangential term");
    v.Field("p2", p2, InRange{-0.1, 0.1}, "second tangential term");
    v.Field("k3", k3, InRange{-1000, 1000}, "third radial term");
    v.Field("k4", k4, InRange{-1000, 1000}, "rational: first term of the denominator; or fourth");
    v.Field("k5", k5, InRange{-1000, 1000}, "rational: second term of the denominator");
    v.Field("k6", k6, InRange{-1000, 1000}, "rational: third term of the denominator");
    v.Field("s1", s1, InRange{-0.1, 0.1}, "thin prism: shift to the right per r2");
    v.Field("s2", s2, InRange{-1, 1}, "thin prism: shift to the right per r4");
    v.Field("s3", s3, InRange{-0.1, 0.1}, "thin prism: downward shift per r2");
    v.Field("s4", s4, InRange{-1, 1}, "thin prism: downward shift per r4");
  }

  /// Calls `f(name, value)` for each term that `model` does not have.
  template <typename Function>
  void ForEachUnused(const Function& f) const {
    const bool is_fisheye = model == LensModel::kKannalaBrandt;
    const bool has_prism = model == LensModel::kThinPrism;
    const bool is_rational = model == LensModel::kRational || has_prism;
    const auto unused = [&](bool is_unused, const char* name, double value) {
      if (is_unused) f(name, value);
    };
    unused(is_fisheye, "p1", p1);
    unused(is_fisheye, "p2", p2);
    unused(!is_rational && !is_fisheye, "k4", k4);
    unused(!is_rational, "k5", k5);
    unused(!is_rational, "k6", k6);
    unused(!has_prism, "s1", s1);
    unused(!has_prism, "s2", s2);
    unused(!has_prism, "s3", s3);
    unused(!has_prism, "s4", s4);
  }
};

/// The camera with `lens` at `intrinsics`. Terms that its model does not have are ignored.
AnyCamera MakeCamera(const Intrinsics& intrinsics, const LensConfig& lens);

}  // namespace windhover
