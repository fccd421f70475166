#pragma once

#include <optional>
#include <utility>
#include <variant>

#include <Eigen/Core>

#include "camera/camera_model.h"
#include "camera/intrinsics.h"
#include "camera/kannala_brandt.h"
#include "camera/pinhole_radtan.h"
#include "camera/pinhole_rational.h"

namespace windhover {

/// A camera of one of our models, chosen at run time.
class AnyCamera {
 public:
  using Model = std::variant<PinholeRadtan, PinholeRational, KannalaBrandt>;

  /// A pinhole with a focal length of 1 px.
  constexpr AnyCamera() : model_(PinholeRadtan{1, 1, 0, 0}) {}
  constexpr AnyCamera(const PinholeRadtan& model) : model_(model) {}
  AnyCamera(const PinholeRational& model) : model_(model) {}
  AnyCamera(const KannalaBrandt& model) : model_(model) {}

  /// Calls `function` with the model itself: once, outside a loop over many points.
  template <typename Function>
  decltype(auto) Visit(Function&& function) const {
    return std::visit(std::forward<Function>(function), model_);
  }

  /// As the model's.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& p_CQ_m,
                                         PixelFromPointJacobian* dq_dp = nullptr) const {
    return Visit([&](const auto& model) { return model.Project(p_CQ_m, dq_dp); });
  }
  /// As the model's.
  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& q_px) const {
    return Visit([&](const auto& model) { return model.Unproject(q_px); });
  }

  /// The model as an M. @throws std::bad_variant_access if it is another.
  template <CameraModel M>
  const M& As() const {
    return std::get<M>(model_);
  }

  template <CameraModel M>
  M& As() {
    return std::get<M>(model_);
  }

  Intrinsics intrinsics() const {
    return Visit([](const auto& m) { return Intrinsics{m.fx_px, m.fy_px, m.cx_px, m.cy_px}; });
  }
  double fx_px() const { return intrinsics().fx_px; }

  /// The same lens in front of a sensor that is placed otherwise.
  AnyCamera With(const Intrinsics& intrinsics) const;

 private:
  Model model_;
};

static_assert(CameraModel<AnyCamera>);

}  // namespace windhover
