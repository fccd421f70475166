#include "learn/fit_priors.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "common/random/random_stream.h"

namespace windhover {
namespace {

StereoRig Rig() {
  return {PinholeRadtan{3200, 3200, 640, 360}, PinholeRadtan{3200, 3200, 640, 360}, 0.4, 1280, 720};
}

struct Truth {
  double offset_px = 70, offset_sigma_px = 5, lever_m = 0.2, excess_sigma_m = 0.1;
  double noise_px = 2, noise_relative = 0.03, size_noise = 0.05, gross_rate = 0;
};

/// Flights from 5 m to 40 m of a target that is 0.9 m wide and 0.4 m high.
std::vector<StereoTuple> Draw(const Truth& truth, int n_flights) {
  RandomStream random(9, "tuples");
  std::vector<StereoTuple> tuples;
  for (int flight = 0; flight < n_flights; ++flight) {
    const double offset_px = truth.offset_px + truth.offset_sigma_px * random.Normal();
    const double excess_m = truth.lever_m + truth.excess_sigma_m * random.Normal();
    for (int i = 0; i < 200; ++i) {
      const double range_m = 5 + 35 * i / 199.0;
      const double size = std::exp(truth.size_noise * random.Normal());
      const double width_px = 3200 * 0.9 / range_m;
      double disparity_px =
          1280 / range_m + offset_px +
          std::hypot(truth.noise_px, truth.noise_relative * width_px) * random.Normal();
      if (random.Uniform() < truth.gross_rate) disparity_px += 0.3 * width_px * random.Normal();
      StereoTuple tuple;
      tuple.box.left.x_px = 640 + disparity_px / 2;
      tuple.box.right.x_px = 640 - disparity_px / 2;
      tuple.box.left.y_px = tuple.box.right.y_px = 360;
      tuple.box.left.w_px = tuple.box.right.w_px = width_px * size;
      tuple.box.left.h_px = tuple.box.right.h_px =
          3200 * 0.4 / range_m * std::exp(0.2 * random.Normal());
      tuple.range_m = range_m + excess_m;
      tuple.range_true_m = range_m;
      tuple.flight = flight;
      tuple.utime = i * 100'000;
      tuples.push_back(tuple);
    }
  }
  return tuples;
}

double SizeAt(const FittedPriors& priors, double range_m) {
  return std::exp(priors.size_log_m + priors.width_exponent * std::log(0.9 / range_m) +
                  priors.height_exponent * std::log(0.4 / range_m));
}

TEST(FitPriors, FindsWhatTuplesWereDrawnWith) {
  for (const double gross_rate : {0.0, 0.03}) {
    Truth truth;
    truth.gross_rate = gross_rate;
    const FittedPriors priors = FitPriors(Draw(truth, 24), Rig());
    // Four standard deviations of a median (1.25) and a mean over 24 flights.
    EXPECT_NEAR(priors.offset_px, 70, 4 * 1.25 * 5 / std::sqrt(24.0));
    EXPECT_NEAR(priors.lever_m, 0.2, 4 * 0.1 / std::sqrt(24.0));
    EXPECT_NEAR(priors.offset_sigma_px, 5, 4 * 5 / std::sqrt(2 * 23.0));
    EXPECT_NEAR(priors.disparity_sigma_px, 2, 1);
    EXPECT_NEAR(priors.disparity_sigma_relative, 0.03, 0.006);
    EXPECT_NEAR(priors.size_sigma, 0.05, 0.01);
    for (const double range_m : {6.0, 15.0, 38.0}) {
      EXPECT_NEAR(SizeAt(priors, range_m) / (range_m + 0.2), 1, 0.02) << range_m;
    }
  }
}

TEST(FitPriors, RefusesTooLittleAndWrongLabels) {
  std::vector<StereoTuple> tuples = Draw({}, 3);
  EXPECT_NO_THROW(FitPriors(tuples, Rig()));
  EXPECT_THROW(FitPriors({}, Rig()), std::invalid_argument);
  EXPECT_THROW(FitPriors(std::span(tuples).first(400), Rig()), std::invalid_argument);
  tuples[5].range_m = 0;
  EXPECT_THROW(FitPriors(tuples, Rig()), std::invalid_argument);
}

}  // namespace
}  // namespace windhover
