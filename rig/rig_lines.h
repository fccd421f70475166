#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "rig/sinusoids.h"

namespace windhover {

/// How the rig moves: a common rotation (vector in R, rad), and the deflection of both tips
/// forward and up, m.
struct RigDeflection {
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();
  double forward_m = 0;
  double up_m = 0;
};

/// Five sums of sinusoids, the degrees of freedom of RigDeflection, evaluated together.
class RigLines {
 public:
  static constexpr int kSize = 5;
  using Vector = Eigen::Matrix<double, kSize, 1>;

  /// `line_spacing_hz`: not 0 if every frequency is a multiple of it and the same in all sums;
  /// then one sine and cosine in sixteen is computed and the others follow by rotation.
  RigLines(std::array<Sinusoids, kSize> sums, double line_spacing_hz);

  bool empty() const;

  /// The sums at time `t_s`: turn x y z, forward, up.
  Vector At(double t_s) const;

  /// No sum is ever further from 0 than this.
  const Vector& Largest() const { return largest_; }

  /// No second derivative is ever further from 0 than this, per s².
  const Vector& LargestCurvature() const { return largest_curvature_; }

 private:
  static constexpr int kBlock = 16;

  Vector AtHarmonics(double t_s) const;
  void StoreHarmonics();

  std::array<Sinusoids, kSize> sums_;
  double line_spacing_hz_;
  Vector largest_, largest_curvature_;

  // Of harmonic n = first_harmonic_ + i, for each sum: cosine_[s][i] cos - sine_[s][i] sin.
  int first_harmonic_ = 0;
  std::array<std::vector<double>, kSize> cosine_, sine_;
};

}  // namespace windhover
