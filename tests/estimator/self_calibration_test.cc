#include "estimator/self_calibration.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "common/random/random_stream.h"
#include "estimator/fusion.h"
#include "tests/support/numeric_derivative.h"

namespace windhover {
namespace {

using Eigen::Vector3d;
constexpr double kTick_s = 0.1;

Utime TimeOf(int tick) { return static_cast<Utime>(tick) * 100'000; }

AircraftConfig Config() {
  AircraftConfig config;
  config.estimator.target_width_m = 0.8;
  config.estimator.disparity_sigma_px = 3;
  config.estimator.size_sigma = 0.06;
  return config;
}

/// Boxes of a target of `width_m` as a rig sees it whose principal points are `offset_px` apart.
stereo_box_t BoxOf(const AircraftConfig& config, const Vector3d& p_RT_m, double width_m,
                   double offset_px) {
  const StereoRig rig = config.rig.ToStereoRig();
  const auto pixels = Project(Posed(rig), p_RT_m);
  stereo_box_t box{};
  box.left.x_px = pixels->left_px.x() + offset_px / 2;
  box.right.x_px = pixels->right_px.x() - offset_px / 2;
  box.left.y_px = pixels->left_px.y();
  box.right.y_px = pixels->right_px.y();
  box.left.w_px = box.right.w_px = rig.left.fx_px() * width_m / p_RT_m.z();
  box.left.h_px = box.right.h_px = box.left.w_px / 2;
  box.score = 1;
  return box;
}

StereoObservation Observation(int tick, const stereo_box_t& box, int track_id = 0) {
  StereoObservation observation;
  observation.box = box;
  observation.utime = TimeOf(tick);
  observation.track_id = track_id;
  return observation;
}

/// Out to 30 m and back to 6 m in 24 s.
Vector3d OutAndBack(double t_s) {
  return {0.02 * t_s, -0.3, 18 - 12 * std::cos(2 * std::numbers::pi * t_s / 24)};
}

TEST(SelfCalibration, FirstFrameWorkedExample) {
  // f B = 3200 px · 0.4 m = 1280 px m. 64 px are 20 m, give or take 10 px: ρ = 0.05 ± 0.0078. The
  // size says 20 m, give or take 12.5 %: ρ = 0.05 ± 0.00625. Both: ± 0.00488, 1.952 m of 20 m.
  AircraftConfig config = Config();
  config.rig.pixel_um = 3.75;
  config.rig.baseline_m = 0.4;
  config.rig.image = {1281, 721};  // The principal point is pixel (640, 360).
  config.estimator.disparity_sigma_px = 6;
  config.estimator.size_sigma = 0.1;
  config.estimator.selfcal.offset_sigma_px = 8;
  config.estimator.selfcal.size_inflation = 1;
  config.estimator.selfcal.size_bias_sigma = 0.075;
  SelfCalibration selfcal(config, UnfittedSetup(config));
  const auto solution = selfcal.Estimate(Observation(0, BoxOf(config, {0, 0, 20}, 0.8, 0)));
  ASSERT_TRUE(solution);
  // Parallax is curved over ± 10 % of range: of second order, 1 % of the range, a few of its σ.
  EXPECT_NEAR(solution->range_m, 20, 0.2);
  EXPECT_NEAR(solution->range_sigma_m, 1.952, 0.08);
  EXPECT_NEAR((solution->p_RT_m - Vector3d(0, 0, solution->range_m)).norm(), 0, 1e-9);
}

TEST(SelfCalibration, FindsOffsetAndSizeWhenTheTargetComesAndGoes) {
  for (const double offset_px : {-25.0, 0.0, 10.0, 25.0}) {
    for (const double width_m : {0.65, 0.8, 1.0}) {
      AircraftConfig config = Config();
      config.estimator.offset1_px = 40;
      config.estimator.size_sigma = 0.02;
      config.estimator.disparity_sigma_px = 0.5;
      config.rig.distortion = {.k1 = -0.1};
      SelfCalibration selfcal(config, UnfittedSetup(config));
      double range_m = 0;
      for (int tick = 0; tick < 240; ++tick) {
        const Vector3d p_RT_m = OutAndBack(tick * kTick_s);
        const auto solution =
            selfcal.Estimate(Observation(tick, BoxOf(config, p_RT_m, width_m, 40 + offset_px)));
        ASSERT_TRUE(solution);
        range_m = solution->range_m / p_RT_m.norm();
      }
      // Of 20 % and more of error at first (size) a twentieth is left.
      EXPECT_NEAR(range_m, 1, 0.012) << offset_px << " " << width_m;
      EXPECT_NEAR(selfcal.offset_px(), 40 + offset_px, 2) << offset_px << " " << width_m;
    }
  }
}

TEST(SelfCalibrationFilter, DerivativesAreThoseOfTheirFunctions) {
  using Input = Eigen::Matrix<double, 1, 1>;
  for (const double log_range : {0.5, 2.0, 3.0, 4.5}) {
    for (const double cosine : {0.9, 1.0}) {
      const auto disparity = [&](const Input& l) {
        return Input(PredictDisparity(1305, l(0), cosine, 7).disparity_px);
      };
      const Input at(log_range);
      // 1e-6: truncation of central differences, step² times the third derivative.
      EXPECT_LT(
          test::RelativeError(Input(PredictDisparity(1305, log_range, cosine, 7).by_log_range),
                              test::NumericDerivative<1, 1>(disparity, at, 1e-4)),
          1e-6);
    }
    for (const double lever_m : {-0.3, 0.0, 0.2}) {
      const auto size = [&](const Input& l) {
        return Input(PredictSize(l(0), lever_m, 0.1).log_m);
      };
      EXPECT_LT(test::RelativeError(Input(PredictSize(log_range, lever_m, 0.1).by_log_range),
                                    test::NumericDerivative<1, 1>(size, Input(log_range), 1e-4)),
                1e-6);
    }
  }
}

TEST(SelfCalibrationFilter, IsAKalmanFilterWhereEverythingIsLinear) {
  // Offset known, sizes worthless, disparities so good that their curvature does not matter: a
  // constant-velocity Kalman filter over range and speed must say the same.
  constexpr double kFarRig_px_m = 130'000, kNoise_px = 0.2;
  SelfCalibrationModel model;
  model.focal_baseline_px_m = kFarRig_px_m;
  model.offset_sigma_px = model.offset_walk_pxps = 0;
  model.size_sigma = 1e3;
  model.acceleration_mps2 = 1.5;
  SelfCalibrationFilter filter(model);
  Eigen::Vector2d x;
  Eigen::Matrix2d P;
  RandomStream random(5, "kalman");
  for (int tick = 0; tick < 60; ++tick) {
    const double t_s = tick * kTick_s;
    const double truth_m = 200 + 2 * t_s - 0.1 * t_s * t_s;
    const double disparity_px = kFarRig_px_m / truth_m + kNoise_px * random.Normal();
    const double measured_m = kFarRig_px_m / disparity_px;
    if (tick == 0) {
      x = {measured_m, 0};
      P = Eigen::Vector2d(160'000, model.speed_sigma_mps * model.speed_sigma_mps).asDiagonal();
    } else {
      const Eigen::Matrix2d F = (Eigen::Matrix2d() << 1, kTick_s, 0, 1).finished();
      Eigen::Matrix2d Q;
      Q << std::pow(kTick_s, 3) / 3, kTick_s * kTick_s / 2, kTick_s * kTick_s / 2, kTick_s;
      x = F * x;
      P = F * P * F.transpose() + 1.5 * 1.5 * Q;
    }
    const double sigma_m = x(0) * x(0) / kFarRig_px_m * kNoise_px;
    const Eigen::Vector2d K = P.col(0) / (P(0, 0) + sigma_m * sigma_m);
    x += K * (measured_m - x(0));
    P -= K * P.row(0).eval();
    SelfCalibrationFilter::Sighting sighting;
    sighting.utime = TimeOf(tick);
    sighting.disparity_px = disparity_px;
    sighting.disparity_sigma_px = kNoise_px;
    sighting.size_log_m = std::log(200);
    const auto belief = filter.Observe(sighting);
    // Curvature: 0.15 %, which a speed of 3 m/s adds to the range in a tick at first.
    EXPECT_NEAR(belief.range_m, x(0), 3e-3) << tick;
    EXPECT_NEAR(belief.range_sigma_m / std::sqrt(P(0, 0)), 1, 4e-3) << tick;
  }
}

TEST(SelfCalibrationFilter, OwnMotionIsNoMotionOfTheTarget) {
  // Towards a target that stands still, at 5 m/s; and past another.
  const auto last_sigma_m = [](bool is_told) {
    SelfCalibrationModel model;
    model.focal_baseline_px_m = 1300;
    model.speed_sigma_mps = 0.1;
    model.acceleration_mps2 = 0.1;
    SelfCalibrationFilter filter(model);
    double error_m = 0;
    for (int tick = 0; tick < 40; ++tick) {
      const double range_m = 30 - 5 * kTick_s * tick;
      SelfCalibrationFilter::Sighting sighting;
      sighting.utime = TimeOf(tick);
      if (is_told) sighting.v_WR_mps = {5, 1, 0};  // Across does not count.
      sighting.disparity_px = 1300 / range_m;
      sighting.size_log_m = std::log(range_m);
      error_m = filter.Observe(sighting).range_m - range_m;
    }
    return std::abs(error_m);
  };
  EXPECT_LT(last_sigma_m(true), 0.05);
  EXPECT_GT(last_sigma_m(false), 0.5);
}

/// What a filter's model says may happen, happens: everything that it calls uncertain is drawn.
class DrawnFlight {
 public:
  DrawnFlight(const SelfCalibrationModel& model,
              const std::vector<SelfCalibrationHypothesis>& hypotheses, int number)
      : model_(model), random_(11, "flight " + std::to_string(number)) {
    double sum = 0;
    for (const auto& hypothesis : hypotheses) sum += hypothesis.weight;
    double left = random_.Uniform(0, sum);
    std::size_t i = 0;
    while (i + 1 < hypotheses.size() && left > hypotheses[i].weight) left -= hypotheses[i++].weight;
    offset_px_ = hypotheses[i].offset_sigma_px * random_.Normal();
    bias_ = hypotheses[i].size_bias + hypotheses[i].size_bias_sigma * random_.Normal();
    drift_ = model_.size_drift_sigma * random_.Normal();
    range_m_ = random_.Uniform(20, 30);
    speed_mps_ = model_.speed_sigma_mps * random_.Normal();
  }

  SelfCalibrationFilter::Sighting Next() {
    SelfCalibrationFilter::Sighting sighting;
    sighting.utime = TimeOf(tick_++);
    sighting.disparity_sigma_px = 4;
    sighting.disparity_px =
        model_.focal_baseline_px_m / range_m_ + offset_px_ + 4 * random_.Normal();
    sighting.size_log_m =
        std::log(range_m_) + bias_ + drift_ + model_.size_sigma * random_.Normal();
    truth_m_ = range_m_;
    Advance();
    return sighting;
  }

  double truth_m() const { return truth_m_; }

 private:
  void Advance() {
    const double a = std::exp(-kTick_s / model_.size_drift_s);
    drift_ = a * drift_ + model_.size_drift_sigma * std::sqrt(1 - a * a) * random_.Normal();
    offset_px_ += model_.offset_walk_pxps * std::sqrt(kTick_s) * random_.Normal();
    range_m_ += speed_mps_ * kTick_s;
    speed_mps_ += model_.acceleration_mps2 * std::sqrt(kTick_s) * random_.Normal();
  }

  SelfCalibrationModel model_;
  RandomStream random_;
  double offset_px_, bias_, drift_, range_m_, speed_mps_, truth_m_ = 0;
  int tick_ = 0;
};

/// Errors of the range, relative, over noisy frames 100 to 240 of OutAndBack; and the offset.
struct Outcome {
  double worst, offset_px;
};

/// `spoil(tick, &observation)` may change a frame; false: the target is missed.
template <typename Spoil>
Outcome FlyNoisy(const AircraftConfig& config, const Spoil& spoil) {
  SelfCalibration selfcal(config, UnfittedSetup(config));
  RandomStream random(17, "boxes");
  Outcome outcome{0, 0};
  for (int tick = 0; tick < 240; ++tick) {
    const Vector3d p_RT_m = OutAndBack(tick * kTick_s);
    StereoObservation observation = Observation(tick, BoxOf(config, p_RT_m, 0.8, 5));
    for (double* x_px : {&observation.box.left.x_px, &observation.box.right.x_px}) {
      *x_px += 2 * random.Normal();
    }
    for (image_box_t* box : {&observation.box.left, &observation.box.right}) {
      box->w_px *= std::exp(0.04 * random.Normal());
    }
    if (!spoil(tick, &observation)) continue;
    const auto solution = selfcal.Estimate(observation);
    if (!solution) continue;
    const double error = std::abs(solution->range_m / p_RT_m.norm() - 1);
    if (tick >= 100) outcome.worst = std::max(outcome.worst, error);
  }
  outcome.offset_px = selfcal.offset_px();
  return outcome;
}

TEST(SelfCalibration, BearsMissedFramesRestartsAndWrongPairs) {
  const AircraftConfig config = Config();
  const Outcome clean = FlyNoisy(config, [](int, StereoObservation*) { return true; });
  EXPECT_LT(clean.worst, 0.1);
  EXPECT_NEAR(clean.offset_px, 5, 4);
  const auto missed = FlyNoisy(config, [](int tick, StereoObservation*) { return tick % 5 != 0; });
  EXPECT_LT(missed.worst, clean.worst + 0.03);
  const auto restarted = FlyNoisy(config, [](int tick, StereoObservation* observation) {
    observation->track_id = tick / 60;
    return true;
  });
  EXPECT_LT(restarted.worst, clean.worst + 0.05);
  EXPECT_NEAR(restarted.offset_px, 5, 4);
  // One frame in ten has a right box that belongs to something else.
  const auto wrong = FlyNoisy(config, [](int tick, StereoObservation* observation) {
    if (tick % 10 == 3) observation->box.right.x_px -= 60, observation->box.right.y_px += 40;
    return true;
  });
  EXPECT_LT(wrong.worst, clean.worst + 0.05);
  EXPECT_NEAR(wrong.offset_px, 5, 4);
}

TEST(SelfCalibration, TheSameFramesGiveTheSameBits) {
  const AircraftConfig config = Config();
  const auto fly = [&] { return FlyNoisy(config, [](int, StereoObservation*) { return true; }); };
  const Outcome a = fly(), b = fly();
  EXPECT_EQ(a.worst, b.worst);
  EXPECT_EQ(a.offset_px, b.offset_px);
}

TEST(VerticalAlignment, FindsRelativePitchAndRoll) {
  // Right minus left: pitched by 0.1°, rolled by 0.15° (as the preset uavde_12mm).
  const double f_px = 3215, pitch_rad = 0.1 * std::numbers::pi / 180, roll_rad = 1.5 * pitch_rad;
  VerticalAlignment vertical(f_px);
  RandomStream random(3, "vertical");
  for (int i = 0; i < 400; ++i) {
    const double x = 0.15 * std::sin(0.1 * i);
    // The same point through two cameras, each turned by half.
    const Vector3d p_m(10 * x, 0.2, 10);
    const auto seen = [&](double sign) {
      const Eigen::Matrix3d R = (Eigen::AngleAxisd(sign * pitch_rad / 2, Vector3d::UnitX()) *
                                 Eigen::AngleAxisd(sign * roll_rad / 2, Vector3d::UnitZ()))
                                    .toRotationMatrix();
      return Vector3d(R.transpose() * p_m);
    };
    const Vector3d left = seen(-1), right = seen(1);
    const double v_px = f_px * (left.y() / left.z() - right.y() / right.z());
    vertical.Observe(TimeOf(i), v_px + 2 * random.Normal(), x, 2, 3);
  }
  EXPECT_NEAR(vertical.pitch_rad(), pitch_rad, 4 * vertical.pitch_sigma_rad());
  EXPECT_NEAR(vertical.roll_rad(), roll_rad, 4 * vertical.roll_sigma_rad());
  EXPECT_LT(vertical.pitch_sigma_rad(), 0.3 * pitch_rad);
  EXPECT_LT(vertical.roll_sigma_rad(), 0.5 * roll_rad);
  // A pair whose heights are 50 px apart is no pair.
  const double sane_px = -f_px * vertical.pitch_rad();
  EXPECT_GT(vertical.Observe(TimeOf(401), sane_px + 50, 0, 2, 3), 10);
}

TEST(Fusion, WorkedExample) {
  // Disparity and size both say 20 m: ρ = 0.05 ± 0.0078 and ± 0.00625 (the filter's example), so
  // ± 0.00488. Where only the disparity changes, to 16 m, ρ1 = 0.0625, the answer is in between.
  AircraftConfig config = Config();
  config.rig.pixel_um = 3.75;
  config.rig.baseline_m = 0.4;
  config.rig.image = {1281, 721};
  config.estimator.disparity_sigma_px = 10;
  config.estimator.size_sigma = 0.125;
  const auto fusion = MakeRangeEstimator("fusion", config);
  const auto both = fusion->Estimate(Observation(0, BoxOf(config, {0, 0, 20}, 0.8, 0)));
  ASSERT_TRUE(both);
  EXPECT_NEAR(both->range_m, 20, 1e-9);
  EXPECT_NEAR(both->range_sigma_m, 1.952, 1e-3);
  const auto between = fusion->Estimate(Observation(0, BoxOf(config, {0, 0, 20}, 0.8, 16)));
  EXPECT_GT(between->range_m, 16.5);
  EXPECT_LT(between->range_m, 19.5);
}

TEST(SelfCalibrationBank, SplitsSizesWorkedExample) {
  // exp(-(0.2 / 0.1)² / 2) = 0.1353 on either side of 1.
  const auto normal = SplitSizeBias(0.5, 0.1, 0.2, 3, 7);
  ASSERT_EQ(normal.size(), 3u);
  EXPECT_NEAR(normal[0].weight, 0.5 * 0.1353 / 1.2707, 1e-4);
  EXPECT_NEAR(normal[1].weight, 0.5 * 1.0000 / 1.2707, 1e-4);
  EXPECT_DOUBLE_EQ(normal[2].size_bias, 0.2);
  EXPECT_DOUBLE_EQ(normal[2].size_bias_sigma, 0.12);
  EXPECT_DOUBLE_EQ(normal[2].offset_sigma_px, 7);
}

TEST(SelfCalibrationBank, SplitPriorsAreThoseThatWereSplit) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const int n : {5, 11, 20}) {
    for (const double sigma : {0.15, kInfinity}) {
      const double reach = 0.3;
      const auto split = SplitSizeBias(0.4, sigma, reach, n, 7);
      const auto density = [&](double bias) {
        double sum = 0;
        for (const auto& part : split) {
          const double z = (bias - part.size_bias) / part.size_bias_sigma;
          sum += part.weight / part.size_bias_sigma * std::exp(-0.5 * z * z);
        }
        return sum;
      };
      double weight = 0;
      for (const auto& part : split) weight += part.weight;
      EXPECT_NEAR(weight, 0.4, 1e-12);
      // A normal distribution that is a sum of others of width w is wider: σ² + w².
      const double wider = std::hypot(sigma, split[0].size_bias_sigma);
      // A third of the reach is three widths from the ends, except where there are only five.
      for (const double bias : {-0.1, -0.03, 0.05, 0.1}) {
        const double expected = std::exp(-0.5 * std::pow(bias / wider, 2));
        EXPECT_NEAR(density(bias) / density(0) / expected, 1, n == 5 ? 0.05 : 0.02) << n << bias;
      }
    }
  }
}

/// The mean over flights of (error / σ)², and the share within 1.96 σ, each after so many ticks.
struct Consistency {
  std::vector<double> nees;
  double covered = 0;
};

Consistency FlyDrawn(const SelfCalibrationModel& model,
                     const std::vector<SelfCalibrationHypothesis>& hypotheses, int n_flights,
                     const std::vector<int>& at) {
  Consistency result{std::vector<double>(at.size(), 0.0), 0};
  for (int flight = 0; flight < n_flights; ++flight) {
    SelfCalibrationBank bank(model, hypotheses);
    DrawnFlight drawn(model, hypotheses, flight);
    for (int tick = 0; tick <= at.back(); ++tick) {
      const auto belief = bank.Observe(drawn.Next());
      const auto found = std::find(at.begin(), at.end(), tick);
      if (found == at.end()) continue;
      const double error = (belief.range_m - drawn.truth_m()) / belief.range_sigma_m;
      result.nees[static_cast<std::size_t>(found - at.begin())] += error * error / n_flights;
      result.covered += (std::abs(error) <= 1.96) / static_cast<double>(n_flights * at.size());
    }
  }
  return result;
}

SelfCalibrationModel DrawnModel() {
  SelfCalibrationModel model;
  model.focal_baseline_px_m = 1300;
  model.offset_walk_pxps = 0.5;
  model.size_sigma = 0.07;
  model.size_drift_sigma = 0.04;
  model.size_drift_s = 2;
  model.acceleration_mps2 = 0.3;
  model.speed_sigma_mps = 0.8;
  return model;
}

// Means of 300 squares of normal variables are in [0.847, 1.166] in 95 of 100 cases.

TEST(SelfCalibrationBank, IsConsistent) {
  const auto result = FlyDrawn(DrawnModel(), SplitSizeBias(1, 0.1, 0.25, 11, 8), 300, {5, 30, 59});
  for (const double nees : result.nees) {
    EXPECT_GT(nees, 0.847);
    EXPECT_LT(nees, 1.166);
  }
  EXPECT_GT(result.covered, 0.93);
  EXPECT_LT(result.covered, 0.97);
}

TEST(SelfCalibrationBank, IsConsistentOverAllThatMayHaveChanged) {
  // What `fused` expects: as it was, another target, or a rig that was touched.
  AircraftConfig config = Config();
  FittedPriors priors;
  priors.offset_sigma_px = 7;
  priors.size_bias_sigma = 0.015;
  const auto hypotheses = FittedSetup(config, priors).hypotheses;
  const auto result = FlyDrawn(DrawnModel(), hypotheses, 300, {5, 30, 59});
  for (const double nees : result.nees) {
    EXPECT_GT(nees, 0.847);
    EXPECT_LT(nees, 1.166);
  }
  EXPECT_GT(result.covered, 0.93);
  EXPECT_LT(result.covered, 0.97);
}

}  // namespace
}  // namespace windhover
