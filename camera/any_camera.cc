#include "camera/any_camera.h"

namespace windhover {

AnyCamera AnyCamera::With(const Intrinsics& intrinsics) const {
  AnyCamera camera = *this;
  std::visit(
      [&](auto& model) {
        model.fx_px = intrinsics.fx_px;
        model.fy_px = intrinsics.fy_px;
        model.cx_px = intrinsics.cx_px;
        model.cy_px = intrinsics.cy_px;
      },
      camera.model_);
  return camera;
}

}  // namespace windhover
