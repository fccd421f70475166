#pragma once

namespace windhover {

/// What labelled detections of one kind of rig and target taught (learn/fit_priors.h). All errors
/// are measured minus true, all sigmas standard deviations.
///
/// With w, h the geometric mean width and height of both boxes in focal lengths, d the distance
/// that labels measure, r that from the middle of the baseline and θ the angle from the optical
/// axis:
///
///     d = r + lever_m        disparity = f B / (r cos θ) + offset_px
///     log(d cos θ) = size_log_m + width_exponent · log w + height_exponent · log h
struct FittedPriors {
  double offset_px = 0;
  double offset_sigma_px = 0;           ///< Of the offset, between flights.
  double lever_m = 0;                   ///< By how much labels are longer than ranges.
  double disparity_sigma_px = 1;        ///< Of one disparity, within a flight: this and, in
  double disparity_sigma_relative = 0;  ///< quadrature, this times the box's width.
  double size_log_m = 0;
  double width_exponent = -1;
  double height_exponent = 0;
  double size_sigma = 0.1;      ///< Of log d, one frame.
  double size_bias_sigma = 0;   ///< Share of that which stays during a flight.
  double size_drift_sigma = 0;  ///< Share of that which lasts for about size_drift_s.
  double size_drift_s = 1;

  /// Calls `v(name, &member, low, high)` for each member: what files hold, and within which limits.
  template <typename Visitor>
  void ForEach(Visitor&& v) {
    v("offset_px", &offset_px, -1000.0, 1000.0);
    v("offset_sigma_px", &offset_sigma_px, 0.0, 1000.0);
    v("lever_m", &lever_m, -5.0, 5.0);
    v("disparity_sigma_px", &disparity_sigma_px, 1e-3, 1000.0);
    v("disparity_sigma_relative", &disparity_sigma_relative, 0.0, 1.0);
    v("size_log_m", &size_log_m, -20.0, 20.0);
    v("width_exponent", &width_exponent, -5.0, 5.0);
    v("height_exponent", &height_exponent, -5.0, 5.0);
    v("size_sigma", &size_sigma, 1e-4, 3.0);
    v("size_bias_sigma", &size_bias_sigma, 0.0, 3.0);
    v("size_drift_sigma", &size_drift_sigma, 0.0, 3.0);
    v("size_drift_s", &size_drift_s, 1e-3, 1000.0);
  }
};

}  // namespace windhover
