#include "camera/lens_config.h"

namespace windhover {

AnyCamera MakeCamera(const Intrinsics& intrinsics, const LensConfig& lens) {
  const auto& [fx_px, fy_px, cx_px, cy_px] = intrinsics;
  PinholeRational::Terms terms{.k1 = lens.k1,
                               .k2 = lens.k2,
                               .p1 = lens.p1,
                               .p2 = lens.p2,
                               .k3 = lens.k3,
                               .k4 = lens.k4,
                               .k5 = lens.k5,
                               .k6 = lens.k6};
  switch (lens.model) {
    case LensModel::kRadtan:
      break;
    case LensModel::kThinPrism:
      terms.s1 = lens.s1;
      terms.s2 = lens.s2;
      terms.s3 = lens.s3;
      terms.s4 = lens.s4;
      return PinholeRational(intrinsics, terms);
    case LensModel::kRational:
      return PinholeRational(intrinsics, terms);
    case LensModel::kKannalaBrandt:
      return KannalaBrandt(intrinsics,
                           {.k1 = lens.k1, .k2 = lens.k2, .k3 = lens.k3, .k4 = lens.k4});
  }
  return PinholeRadtan{.fx_px = fx_px,
                       .fy_px = fy_px,
                       .cx_px = cx_px,
                       .cy_px = cy_px,
                       .k1 = lens.k1,
                       .k2 = lens.k2,
                       .p1 = lens.p1,
                       .p2 = lens.p2,
                       .k3 = lens.k3};
}

}  // namespace windhover
