#include "estimator/joint_mlp.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace windhover {
namespace {

constexpr int kHidden = JointMlp::kHidden, kInputs = JointMlp::kInputs;

template <int kRows, int kColumns>
using WeightsOf = Eigen::Map<const Eigen::Matrix<float, kRows, kColumns, Eigen::RowMajor>>;

template <int kRows>
using BiasOf = Eigen::Map<const Eigen::Matrix<float, kRows, 1>>;

}  // namespace

JointMlp::Inputs JointMlp::InputsOf(const CorrectableBoxes& boxes) {
  // Range and sizes as triangulation has them, so that another focal length changes nothing; a
  // disparity of a few pixels says no more than that the target is far.
  const float disparity = std::max(boxes.Disparity(), 5 / boxes.image_width_px);
  const float aspect = boxes.image_height_px / boxes.image_width_px;
  const float w = std::sqrt(boxes.w[0] * boxes.w[1]);
  const float h = std::sqrt(boxes.h[0] * boxes.h[1]) * aspect;
  Inputs inputs;
  inputs << std::log(boxes.Range_m(disparity)), std::log(w / boxes.range_m),
      std::log(h / boxes.range_m), (boxes.x[0] + boxes.x[1] - 1) / 2,
      (boxes.y[0] + boxes.y[1] - 1) / 2 * aspect, (boxes.y[0] - boxes.y[1]) * aspect,
      std::log(boxes.w[0] / boxes.w[1]), std::log(boxes.h[0] / boxes.h[1]);
  return inputs;
}

JointMlp::JointMlp(Parameters parameters) : parameters_(std::move(parameters)) {
  if (parameters_.weights.size() != kParameters) {
    throw std::invalid_argument(
        fmt::format("must be {} numbers (found {})", kParameters, parameters_.weights.size()));
  }
}

float JointMlp::LogRange(const Inputs& inputs) const {
  // Products coefficient by coefficient: g++ 12 misreads the loops of the general one at -O3.
  using Hidden = Eigen::Matrix<float, kHidden, 1>;
  const auto activate = [](const Hidden& x) -> Hidden {
    return x.array() / (1 + (-x.array()).exp());
  };
  const float* p = parameters_.weights.data();
  const Inputs unit = (inputs - parameters_.mean).cwiseQuotient(parameters_.scale);
  const Hidden first = activate(WeightsOf<kHidden, kInputs>(p).lazyProduct(unit) +
                                BiasOf<kHidden>(p + kHidden * kInputs));
  p += kHidden * (kInputs + 1);
  const Hidden second = activate(WeightsOf<kHidden, kHidden>(p).lazyProduct(first) +
                                 BiasOf<kHidden>(p + kHidden * kHidden));
  p += kHidden * (kHidden + 1);
  return parameters_.mean_log_m + BiasOf<kHidden>(p).dot(second) + p[kHidden];
}

JointMlpEstimator::JointMlpEstimator(const AircraftConfig& config, JointMlp mlp)
    : rig_(config.rig.ToStereoRig()), mlp_(std::move(mlp)) {}

std::optional<RangeSolution> JointMlpEstimator::Solve(const StereoObservation& observation) {
  const auto boxes = MakeCorrectable(rig_, observation.box);
  if (!boxes) return std::nullopt;
  const double range_m = std::exp(mlp_.LogRange(JointMlp::InputsOf(*boxes)));
  return RangeSolution{range_m * RayOf(*boxes, rig_), range_m,
                       range_m * mlp_.parameters().range_sigma, /*n_stages=*/0};
}

}  // namespace windhover
