#pragma once

#include <vector>

#include <Eigen/Core>

#include "common/time/sim_time.h"

namespace windhover {

/// What the filter expects before it has seen anything.
struct SelfCalibrationModel {
  double focal_baseline_px_m = 1;    ///< f · B.
  double lever_m = 0;                ///< Distance that sizes speak of, minus the range.
  double offset_sigma_px = 15;       ///< Of the disparity offset about 0.
  double offset_walk_pxps = 0.7;     ///< Its random walk, px per √s.
  double size_sigma = 0.1;           ///< Of the log distance by size: what differs each frame,
  double size_bias_sigma = 0.15;     ///< what stays,
  double size_bias_walk_ps = 0.002;  ///< (its random walk, per √s)
  double size_drift_sigma = 0;       ///< and what lasts for about size_drift_s.
  double size_drift_s = 3;
  double speed_sigma_mps = 3;    ///< Of targets along the line of sight, in W.
  double acceleration_mps2 = 2;  ///< The same, rms, changing every second.
  double gate_sigma = 3;         ///< Innovations beyond this weigh less.
};

/// A measurement's prediction and its derivative by the state.
struct DisparityPrediction {
  double disparity_px, by_log_range;  ///< By the offset: 1.
};
struct SizePrediction {
  double log_m, by_log_range;  ///< By the bias and the drift: 1.
};

/// fB / (r cos θ) + offset, with θ the angle between the line of sight and the optical axis.
DisparityPrediction PredictDisparity(double focal_baseline_px_m, double log_range, double cosine,
                                     double offset_px);

/// log(r + lever) + bias.
SizePrediction PredictSize(double log_range, double lever_m, double bias);

/// One extended Kalman filter over a rig and all the targets it follows:
///
///     rig      o    disparity offset, px                         random walk
///     target   l    log of the range r from the rig's middle     r' = s - v_WR · u
///              s    speed in W along the line of sight u, m/s    white acceleration
///              b    bias of the log distance by its size         random walk
///              a    drift of the same (attitude)                 first-order Gauss-Markov
///
///     disparity   fB / (r cos θ) + o + noise       size   log(r + lever) + b + a + noise
///
/// The joint covariance lets every target teach the offset and profit from it, and a target that
/// goes takes with it only what was its own. Measurements far from what is expected count less:
/// beyond the gate the innovation's variance grows with its square. A target that is beyond
/// the gate time and again is begun anew. Source: Y. Bar-Shalom et al., "Estimation with
/// Applications to Tracking and Navigation", 2001, chapters 5.4 (consistency), 10.3 (EKF),
/// 10.5 (iterated).
class SelfCalibrationFilter {
 public:
  explicit SelfCalibrationFilter(const SelfCalibrationModel& model);

  struct Sighting {
    Utime utime = 0;
    int track_id = 0;
    Eigen::Vector3d direction_W = Eigen::Vector3d::UnitX();  ///< u, unit length.
    Eigen::Vector3d v_WR_mps = Eigen::Vector3d::Zero();
    double cosine = 1;        ///< Of θ.
    double disparity_px = 0;  ///< f (x_L - x_R), of undistorted image coordinates.
    double disparity_sigma_px = 5;
    double size_log_m = 0;  ///< Log of the distance by the box's size.
    double doubt = 1;       ///< Factor on the variances of both measurements.
  };
  struct Belief {
    double range_m = 0, range_sigma_m = 0;
    double size_bias = 0;       ///< b + a.
    double log_likelihood = 0;  ///< Of both measurements, but for a constant.
  };

  /// What to believe of a target once it has been seen so. In order of time.
  Belief Observe(const Sighting& sighting);

  double offset_px() const { return x_(0); }
  double offset_sigma_px() const;

 private:
  static constexpr int kMaxTracks = 8, kPerTrack = 4, kMaxStates = 1 + kPerTrack * kMaxTracks;
  enum TrackState { kLogRange, kSpeed, kBias, kDrift };
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxStates, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxStates, kMaxStates>;

  struct Track {
    int id;
    Utime last_seen;
    Eigen::Vector3d direction_W;
    int strikes;  ///< Frames beyond the gate, without one inside.
  };

  /// A scalar measurement: where it depends on the state, and how.
  struct Gradient {
    int at[3];
    double by[3];
    int n;
  };

  void Predict(Utime utime, const Eigen::Vector3d& v_WR_mps);
  void PredictTrack(int base, double dt_s, double own_speed_mps);
  void Forget(Utime utime);
  void Remove(std::size_t track);
  std::size_t TrackOf(const Sighting& sighting);
  void Begin(std::size_t track, const Sighting& sighting);
  bool UpdateSize(int base, const Sighting& sighting);
  bool UpdateDisparity(int base, const Sighting& sighting);
  Vector CovarianceWith(const Gradient& gradient) const;
  double Gated(double innovation, double variance, bool* inside);
  static int BaseOf(std::size_t track) { return 1 + kPerTrack * static_cast<int>(track); }

  SelfCalibrationModel model_;
  std::vector<Track> tracks_;
  Utime utime_ = 0;
  bool began_ = false;
  double log_likelihood_ = 0;
  Vector x_;
  Matrix P_;
};

}  // namespace windhover
