#include "estimator/self_calibration_bank.h"

#include <algorithm>
#include <cmath>

namespace windhover {
namespace {

constexpr double kForNewTarget = 0.1;  // Share of the prior when a target appears.
constexpr double kLeastWeight = 1e-9;  // Nothing is ever impossible.
constexpr std::size_t kTracksKnown = 16;

}  // namespace

std::vector<SelfCalibrationHypothesis> SplitSizeBias(double weight, double sigma, double reach,
                                                     int n, double offset_sigma_px) {
  std::vector<SelfCalibrationHypothesis> hypotheses;
  const double spacing = 2 * reach / (n - 1);
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double bias = i * spacing - reach;
    const double density = std::exp(-0.5 * std::pow(bias / sigma, 2));
    // 0.6 of the spacing makes the sum of normal distributions flat to 1 %.
    hypotheses.push_back({density, bias, 0.6 * spacing, offset_sigma_px});
    sum += density;
  }
  for (SelfCalibrationHypothesis& hypothesis : hypotheses) hypothesis.weight *= weight / sum;
  return hypotheses;
}

SelfCalibrationBank::SelfCalibrationBank(const SelfCalibrationModel& model,
                                         const std::vector<SelfCalibrationHypothesis>& hypotheses) {
  double sum = 0;
  for (const SelfCalibrationHypothesis& hypothesis : hypotheses) sum += hypothesis.weight;
  for (const SelfCalibrationHypothesis& hypothesis : hypotheses) {
    SelfCalibrationModel own = model;
    own.offset_sigma_px = hypothesis.offset_sigma_px;
    own.size_bias_sigma = hypothesis.size_bias_sigma;
    const double prior = hypothesis.weight / sum;
    members_.push_back({prior, prior, hypothesis.size_bias, SelfCalibrationFilter(own)});
  }
  beliefs_.resize(members_.size());
}

SelfCalibrationFilter::Belief SelfCalibrationBank::Observe(
    const SelfCalibrationFilter::Sighting& sighting) {
  Welcome(sighting.track_id);
  SelfCalibrationFilter::Sighting shifted = sighting;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    shifted.size_log_m = sighting.size_log_m - members_[i].size_bias;
    beliefs_[i] = members_[i].filter.Observe(shifted);
    beliefs_[i].size_bias += members_[i].size_bias;
  }
  Weigh(beliefs_);
  SelfCalibrationFilter::Belief all;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    all.range_m += members_[i].weight * beliefs_[i].range_m;
    all.size_bias += members_[i].weight * beliefs_[i].size_bias;
  }
  double variance = 0;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    const double apart_m = beliefs_[i].range_m - all.range_m;
    variance += members_[i].weight *
                (beliefs_[i].range_sigma_m * beliefs_[i].range_sigma_m + apart_m * apart_m);
  }
  all.range_sigma_m = std::sqrt(variance);
  return all;
}

void SelfCalibrationBank::Welcome(int track_id) {
  if (std::count(known_tracks_.begin(), known_tracks_.end(), track_id) > 0) return;
  if (known_tracks_.size() == kTracksKnown) known_tracks_.erase(known_tracks_.begin());
  known_tracks_.push_back(track_id);
  for (Member& member : members_) {
    member.weight = (1 - kForNewTarget) * member.weight + kForNewTarget * member.prior;
  }
}

void SelfCalibrationBank::Weigh(const std::vector<SelfCalibrationFilter::Belief>& beliefs) {
  double best = beliefs[0].log_likelihood;
  for (const auto& belief : beliefs) best = std::max(best, belief.log_likelihood);
  double sum = 0;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    double& weight = members_[i].weight;
    weight = std::max(weight * std::exp(beliefs[i].log_likelihood - best), kLeastWeight);
    sum += weight;
  }
  for (Member& member : members_) member.weight /= sum;
}

double SelfCalibrationBank::offset_px() const {
  double mean_px = 0;
  for (const Member& member : members_) {
    mean_px += member.weight * member.filter.offset_px();
  }
  return mean_px;
}

double SelfCalibrationBank::offset_sigma_px() const {
  const double mean_px = offset_px();
  double variance = 0;
  for (const Member& member : members_) {
    const double apart_px = member.filter.offset_px() - mean_px;
    variance +=
        member.weight * (std::pow(member.filter.offset_sigma_px(), 2) + apart_px * apart_px);
  }
  return std::sqrt(variance);
}

}  // namespace windhover
