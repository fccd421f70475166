#include "estimator/self_calibration.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "estimator/box_geometry.h"
#include "estimator/fusion.h"

namespace windhover {
namespace {

constexpr double kLeastSigma = 1e-3;  // A filter that is certain never learns.
constexpr double kDrift_s = 2;        // A target's attitude, for rigs without labels.
constexpr double kRelativeNoise = 0.03;
constexpr double kAnyDisparity_px = 1e5;  // No image is wider.
// Of a rig with labels: as it was; another target; touched.
constexpr double kAsFitted = 0.3, kOtherTarget = 0.4, kTouched = 0.3;
constexpr double kOwnSize = 0.03;  // How far no two targets of a kind are alike, at least.
constexpr double kReach = 2.2;     // Of sizes of other targets, in size_bias_sigma.
constexpr int kSplit = 11;
constexpr double kAny = std::numeric_limits<double>::infinity();

double Remainder(double all, double part, double another) {
  const double square = all * all - part * part - another * another;
  return std::sqrt(std::max(square, kLeastSigma * kLeastSigma));
}

SelfCalibrationModel ModelOf(const AircraftConfig& config) {
  const SelfcalConfig& selfcal = config.estimator.selfcal;
  SelfCalibrationModel model;
  model.focal_baseline_px_m = config.rig.FocalPx() * config.rig.baseline_m;
  model.offset_walk_pxps = selfcal.offset_walk_pxps;
  model.size_bias_walk_ps = selfcal.size_bias_walk_ps;
  model.acceleration_mps2 = selfcal.acceleration_mps2;
  model.gate_sigma = selfcal.gate_sigma;
  return model;
}

}  // namespace

SelfCalibrationSetup UnfittedSetup(const AircraftConfig& config) {
  const EstimatorConfig& estimator = config.estimator;
  SelfCalibrationSetup setup{UnfittedPriors(estimator), ModelOf(config), {}};
  setup.priors.disparity_sigma_relative = kRelativeNoise;
  // A mean over many frames is as uncertain as if errors were independent and inflated, when a
  // share of their variance lasts: inflation² = 1 + share · 2 τ / dt.
  const double lasting_frames = 2 * kDrift_s * config.frame_rate_hz;
  const double inflation = estimator.selfcal.size_inflation;
  const double share = std::min(1.0, (inflation * inflation - 1) / lasting_frames);
  setup.model.size_drift_s = kDrift_s;
  setup.model.size_drift_sigma = estimator.size_sigma * std::sqrt(share);
  setup.model.size_sigma =
      std::max(estimator.size_sigma * std::sqrt(1 - share), estimator.size_sigma / 4 + kLeastSigma);
  const double size_bias_sigma = std::max(estimator.selfcal.size_bias_sigma, kLeastSigma);
  setup.hypotheses = SplitSizeBias(1, size_bias_sigma, 2.5 * size_bias_sigma, kSplit,
                                   std::max(estimator.selfcal.offset_sigma_px, kLeastSigma));
  return setup;
}

SelfCalibrationSetup FittedSetup(const AircraftConfig& config, const FittedPriors& priors) {
  const SelfcalConfig& selfcal = config.estimator.selfcal;
  SelfCalibrationSetup setup{priors, ModelOf(config), {}};
  setup.model.lever_m = priors.lever_m;
  setup.model.size_sigma =
      Remainder(priors.size_sigma, priors.size_bias_sigma, priors.size_drift_sigma);
  setup.model.size_drift_sigma = priors.size_drift_sigma;
  setup.model.size_drift_s = priors.size_drift_s;
  const double offset_sigma_px = std::max(priors.offset_sigma_px, kLeastSigma);
  const double size_sigma = std::max(priors.size_bias_sigma, kOwnSize);
  const double reach = kReach * std::max(selfcal.size_bias_sigma, size_sigma);
  setup.hypotheses = SplitSizeBias(kOtherTarget, kAny, reach, kSplit, offset_sigma_px);
  setup.hypotheses.push_back({kAsFitted, 0, size_sigma, offset_sigma_px});
  setup.hypotheses.push_back(
      {kTouched, 0, size_sigma, std::hypot(selfcal.offset_sigma_px, offset_sigma_px)});
  return setup;
}

SelfCalibration::SelfCalibration(const AircraftConfig& config, const SelfCalibrationSetup& setup)
    : rig_(config.rig.ToStereoRig()),
      priors_(setup.priors),
      gate_sigma_(setup.model.gate_sigma),
      bank_(setup.model, setup.hypotheses),
      noise_(priors_.disparity_sigma_px, priors_.disparity_sigma_relative),
      vertical_(rig_.left.fx_px()) {}

std::optional<RangeSolution> SelfCalibration::Solve(const StereoObservation& observation) {
  const auto geometry = GeometryOf(rig_, observation.box, priors_.offset_px);
  if (!geometry || !(std::abs(geometry->disparity_px) < kAnyDisparity_px) ||
      !(geometry->width_px < kAnyDisparity_px)) {
    return std::nullopt;
  }
  SelfCalibrationFilter::Sighting sighting;
  sighting.utime = observation.utime;
  sighting.track_id = observation.track_id;
  sighting.direction_W = observation.R_WR * geometry->direction_R;
  sighting.v_WR_mps = observation.v_WR_mps;
  sighting.cosine = geometry->cosine;
  sighting.disparity_px = geometry->disparity_px;
  sighting.disparity_sigma_px = noise_.SigmaPx(geometry->width_px);
  sighting.size_log_m = SizeLog_m(priors_, *geometry);
  const double sigmas = vertical_.Observe(observation.utime, geometry->vertical_px, geometry->x,
                                          sighting.disparity_sigma_px, gate_sigma_);
  sighting.doubt = std::pow(std::max(1.0, sigmas / gate_sigma_), 4);
  noise_.Observe(observation.utime, observation.track_id, geometry->disparity_px,
                 geometry->width_px);
  const SelfCalibrationFilter::Belief belief = bank_.Observe(sighting);
  const double range_m = belief.range_m + priors_.lever_m;
  return RangeSolution{range_m * geometry->direction_R, range_m, belief.range_sigma_m,
                       /*n_stages=*/1};
}

}  // namespace windhover
