#include "estimator/range_estimator.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "estimator/correction_card.h"
#include "estimator/fusion.h"
#include "estimator/joint_mlp.h"
#include "estimator/offset_triangulation.h"
#include "estimator/pcm.h"
#include "estimator/self_calibration.h"
#include "estimator/size_prior.h"
#include "estimator/triangulation.h"

namespace windhover {
namespace {

bool IsBox(const image_box_t& box) {
  return std::isfinite(box.x_px) && std::isfinite(box.y_px) && std::isfinite(box.w_px) &&
         std::isfinite(box.h_px) && box.w_px > 0 && box.h_px > 0;
}

bool IsDistance(const RangeSolution& solution) {
  return solution.p_RT_m.allFinite() && std::isfinite(solution.range_m) && solution.range_m > 0 &&
         std::isfinite(solution.range_sigma_m) && solution.range_sigma_m >= 0;
}

/// What the card of `config` teaches of `section`.
template <typename Section>
Section Learned(const AircraftConfig& config, std::optional<Section> CorrectionCard::*section,
                const char* name) {
  const InputFile& file = config.estimator.correction;
  CorrectionCard card = ReadCorrectionCard(file);
  if (!(card.*section)) {
    throw ConfigError(fmt::format("{}: {}: must have the section '{}' for the methods listed",
                                  file.where, file.as_given, name));
  }
  return *std::move(card.*section);
}

std::unique_ptr<RangeEstimator> MakePositionCorrection(const AircraftConfig& config,
                                                       FurtherStages further) {
  return std::make_unique<PositionCorrection>(config, Learned(config, &CorrectionCard::pcm, "pcm"),
                                              further);
}

/// Works without labels too.
std::unique_ptr<RangeEstimator> MakeFusion(const AircraftConfig& config) {
  if (config.estimator.correction.empty()) return std::make_unique<Fusion>(config);
  return std::make_unique<Fusion>(config, Learned(config, &CorrectionCard::priors, "priors"));
}

}  // namespace

std::optional<RangeSolution> RangeEstimator::Estimate(const StereoObservation& observation) {
  if (!IsBox(observation.box.left) || !IsBox(observation.box.right)) return std::nullopt;
  auto solution = Solve(observation);
  if (!solution || !IsDistance(*solution)) return std::nullopt;
  return solution;
}

std::unique_ptr<RangeEstimator> MakeRangeEstimator(const std::string& method,
                                                   const AircraftConfig& config) {
  if (method == "baseline") return std::make_unique<Triangulation>(config);
  if (method == "offset1") return std::make_unique<OffsetTriangulation>(config);
  if (method == "size") return std::make_unique<SizePrior>(config);
  if (method == "pcm") return MakePositionCorrection(config, FurtherStages::kNone);
  if (method == "pcm_dic") return MakePositionCorrection(config, FurtherStages::kByGate);
  if (method == "pcm_dic_star") return MakePositionCorrection(config, FurtherStages::kForAll);
  if (method == "joint_mlp") {
    return std::make_unique<JointMlpEstimator>(
        config, Learned(config, &CorrectionCard::joint_mlp, "joint_mlp"));
  }
  if (method == "fusion") return MakeFusion(config);
  if (method == "selfcal") {
    return std::make_unique<SelfCalibration>(config, UnfittedSetup(config));
  }
  if (method == "fused") {
    return std::make_unique<SelfCalibration>(
        config, FittedSetup(config, Learned(config, &CorrectionCard::priors, "priors")));
  }
  throw std::invalid_argument(fmt::format("there is no estimation method '{}'", method));
}

}  // namespace windhover
