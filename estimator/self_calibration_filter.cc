#include "estimator/self_calibration_filter.h"

#include <algorithm>
#include <cmath>

namespace windhover {
namespace {

constexpr double kWideLog = 2;  // Standard deviation of a log range that nothing is known of.
constexpr double kLeastLog = -1, kMostLog = 7;  // 0.4 m to 1 km.
constexpr double kLargestStep = 0.5;            // Of the log range in one iteration.
constexpr int kIterations = 4;
constexpr Utime kForgetAfter = 1'500'000;  // The tracker gives no number twice after 1 s.
constexpr double kLongest_s = 10;          // Of one prediction.
constexpr int kMostStrikes = 8;

}  // namespace

DisparityPrediction PredictDisparity(double focal_baseline_px_m, double log_range, double cosine,
                                     double offset_px) {
  const double parallax_px = focal_baseline_px_m / (std::exp(log_range) * cosine);
  return {parallax_px + offset_px, -parallax_px};
}

SizePrediction PredictSize(double log_range, double lever_m, double bias) {
  const double range_m = std::exp(log_range);
  // A lever may be negative; what it leaves is still a distance.
  const double distance_m = std::max(range_m + lever_m, 0.1 * range_m);
  return {std::log(distance_m) + bias, range_m / distance_m};
}

SelfCalibrationFilter::SelfCalibrationFilter(const SelfCalibrationModel& model)
    : model_(model), x_(Vector::Zero(1)), P_(Matrix::Zero(1, 1)) {
  P_(0, 0) = model_.offset_sigma_px * model_.offset_sigma_px;
  tracks_.reserve(kMaxTracks);
}

double SelfCalibrationFilter::offset_sigma_px() const { return std::sqrt(P_(0, 0)); }

SelfCalibrationFilter::Belief SelfCalibrationFilter::Observe(const Sighting& sighting) {
  Predict(sighting.utime, sighting.v_WR_mps);
  Forget(sighting.utime);
  const std::size_t i = TrackOf(sighting);
  const int base = BaseOf(i);
  Track& track = tracks_[i];
  track.last_seen = sighting.utime;
  track.direction_W = sighting.direction_W;
  log_likelihood_ = 0;
  const bool size_is_inside = UpdateSize(base, sighting);
  const bool disparity_is_inside = UpdateDisparity(base, sighting);
  const bool is_strike = !size_is_inside || !disparity_is_inside;
  track.strikes = is_strike ? track.strikes + 1 : 0;
  const double log_likelihood = log_likelihood_;
  if (track.strikes >= kMostStrikes) {
    Begin(i, sighting);
    UpdateSize(base, sighting);
    UpdateDisparity(base, sighting);
  }
  const double range_m = std::exp(x_(base + kLogRange));
  return {range_m, range_m * std::sqrt(P_(base + kLogRange, base + kLogRange)),
          x_(base + kBias) + x_(base + kDrift), log_likelihood};
}

void SelfCalibrationFilter::Predict(Utime utime, const Eigen::Vector3d& v_WR_mps) {
  if (!began_) utime_ = utime;
  began_ = true;
  if (utime <= utime_) return;
  const double dt_s = std::min(static_cast<double>(utime - utime_) * 1e-6, kLongest_s);
  utime_ = utime;
  P_(0, 0) += model_.offset_walk_pxps * model_.offset_walk_pxps * dt_s;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    PredictTrack(BaseOf(i), dt_s, v_WR_mps.dot(tracks_[i].direction_W));
  }
}

void SelfCalibrationFilter::PredictTrack(int base, double dt_s, double own_speed_mps) {
  const int l = base + kLogRange, s = base + kSpeed, a = base + kDrift;
  const double range_m = std::exp(x_(l));
  const double travel_m = (x_(s) - own_speed_mps) * dt_s;
  const double later_m = std::max(range_m + travel_m, 0.2 * range_m);
  // dl'/dl and dl'/ds of l' = log(r + travel).
  const double f_ll = range_m / later_m, f_ls = dt_s / later_m;
  const double f_aa = std::exp(-dt_s / model_.size_drift_s);
  x_(l) = std::log(later_m);
  x_(a) *= f_aa;
  const auto transition = [&](auto&& l_of, auto&& s_of, auto&& a_of) {
    l_of = f_ll * l_of + f_ls * s_of;
    a_of *= f_aa;
  };
  transition(P_.row(l), P_.row(s), P_.row(a));
  transition(P_.col(l), P_.col(s), P_.col(a));
  const double q = model_.acceleration_mps2 * model_.acceleration_mps2;
  P_(l, l) += q * dt_s * dt_s * dt_s / 3 / (later_m * later_m);
  P_(l, s) += q * dt_s * dt_s / 2 / later_m;
  P_(s, l) = P_(l, s);
  P_(s, s) += q * dt_s;
  P_(base + kBias, base + kBias) += model_.size_bias_walk_ps * model_.size_bias_walk_ps * dt_s;
  P_(a, a) += model_.size_drift_sigma * model_.size_drift_sigma * (1 - f_aa * f_aa);
}

void SelfCalibrationFilter::Forget(Utime utime) {
  for (std::size_t i = tracks_.size(); i-- > 0;) {
    if (utime - tracks_[i].last_seen > kForgetAfter) Remove(i);
  }
}

void SelfCalibrationFilter::Remove(std::size_t track) {
  const int base = BaseOf(track), n = static_cast<int>(x_.size());
  const int rest = n - base - kPerTrack;
  // eval(): source and destination overlap.
  x_.segment(base, rest) = x_.tail(rest).eval();
  P_.middleRows(base, rest) = P_.bottomRows(rest).eval();
  P_.middleCols(base, rest) = P_.rightCols(rest).eval();
  x_.conservativeResize(n - kPerTrack);
  P_.conservativeResize(n - kPerTrack, n - kPerTrack);
  tracks_.erase(tracks_.begin() + static_cast<std::ptrdiff_t>(track));
}

std::size_t SelfCalibrationFilter::TrackOf(const Sighting& sighting) {
  const auto found = std::find_if(tracks_.begin(), tracks_.end(), [&](const Track& track) {
    return track.id == sighting.track_id;
  });
  if (found != tracks_.end()) return static_cast<std::size_t>(found - tracks_.begin());
  if (tracks_.size() == kMaxTracks) {
    const auto oldest =
        std::min_element(tracks_.begin(), tracks_.end(),
                         [](const Track& a, const Track& b) { return a.last_seen < b.last_seen; });
    Remove(static_cast<std::size_t>(oldest - tracks_.begin()));
  }
  const int n = static_cast<int>(x_.size());
  x_.conservativeResize(n + kPerTrack);
  P_.conservativeResize(n + kPerTrack, n + kPerTrack);
  tracks_.push_back({sighting.track_id, sighting.utime, sighting.direction_W, 0});
  Begin(tracks_.size() - 1, sighting);
  return tracks_.size() - 1;
}

void SelfCalibrationFilter::Begin(std::size_t track, const Sighting& sighting) {
  const int base = BaseOf(track);
  const double distance_m = std::exp(std::clamp(sighting.size_log_m, kLeastLog, kMostLog));
  x_.segment(base, kPerTrack).setZero();
  x_(base + kLogRange) = std::log(std::max(distance_m - model_.lever_m, 0.1 * distance_m));
  P_.middleRows(base, kPerTrack).setZero();
  P_.middleCols(base, kPerTrack).setZero();
  const auto set = [&](int state, double sigma) { P_(base + state, base + state) = sigma * sigma; };
  set(kLogRange, kWideLog);
  set(kSpeed, model_.speed_sigma_mps);
  set(kBias, model_.size_bias_sigma);
  set(kDrift, model_.size_drift_sigma);
  tracks_[track].strikes = 0;
}

SelfCalibrationFilter::Vector SelfCalibrationFilter::CovarianceWith(
    const Gradient& gradient) const {
  Vector sum = gradient.by[0] * P_.col(gradient.at[0]);
  for (int i = 1; i < gradient.n; ++i) sum += gradient.by[i] * P_.col(gradient.at[i]);
  return sum;
}

double SelfCalibrationFilter::Gated(double innovation, double variance, bool* inside) {
  const double nis = innovation * innovation / variance;
  const double gate = model_.gate_sigma * model_.gate_sigma;
  *inside = nis <= gate;
  log_likelihood_ -=
      0.5 * (std::log(variance) + (*inside ? nis : gate * (1 + std::log(nis / gate))));
  return *inside ? variance : variance * nis / gate;
}

bool SelfCalibrationFilter::UpdateSize(int base, const Sighting& sighting) {
  const int l = base + kLogRange, b = base + kBias, a = base + kDrift;
  const SizePrediction predicted = PredictSize(x_(l), model_.lever_m, x_(b) + x_(a));
  const Gradient h = {{l, b, a}, {predicted.by_log_range, 1, 1}, 3};
  const Vector Ph = CovarianceWith(h);
  const double noise = model_.size_sigma * model_.size_sigma * sighting.doubt;
  const double innovation = sighting.size_log_m - predicted.log_m;
  bool inside = false;
  const double variance =
      Gated(innovation, predicted.by_log_range * Ph(l) + Ph(b) + Ph(a) + noise, &inside);
  x_ += Ph * (innovation / variance);
  P_ -= Ph * Ph.transpose() / variance;
  x_(l) = std::clamp(x_(l), kLeastLog, kMostLog);
  return inside;
}

bool SelfCalibrationFilter::UpdateDisparity(int base, const Sighting& sighting) {
  const int l = base + kLogRange;
  double noise = sighting.disparity_sigma_px * sighting.disparity_sigma_px * sighting.doubt;
  const Vector before = x_;
  Vector Ph;
  double variance = 1;
  bool inside = true;
  for (int i = 0; i < kIterations; ++i) {
    const DisparityPrediction predicted =
        PredictDisparity(model_.focal_baseline_px_m, x_(l), sighting.cosine, x_(0));
    Ph = CovarianceWith({{0, l, 0}, {1, predicted.by_log_range, 0}, 2});
    const double innovation = sighting.disparity_px - predicted.disparity_px - (before(0) - x_(0)) -
                              predicted.by_log_range * (before(l) - x_(l));
    variance = Ph(0) + predicted.by_log_range * Ph(l) + noise;
    if (i == 0) {  // The gate judges by what was expected, not by what came of it.
      const double gated = Gated(innovation, variance, &inside);
      noise += gated - variance;
      variance = gated;
    }
    const double log_range = x_(l);
    x_ = before + Ph * (innovation / variance);
    x_(l) = std::clamp(x_(l), std::max(kLeastLog, log_range - kLargestStep),
                       std::min(kMostLog, log_range + kLargestStep));
  }
  P_ -= Ph * Ph.transpose() / variance;
  return inside;
}

}  // namespace windhover
