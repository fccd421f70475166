#pragma once

#include <string>
#include <vector>

#include "common/time/sim_time.h"
#include "lcmtypes/stereo_box_t.hpp"

namespace windhover {

/// A stereo detection with its label: what corrections are trained on.
struct StereoTuple {
  stereo_box_t box{};
  double range_m = 0;       ///< The label: score.reference of the scenario.
  double range_true_m = 0;  ///< From the middle of the baseline.
  int flight = 0;           ///< Within its split.
  Utime utime = 0;
};

/// A box as data sets give it: centre and size in shares of an image's width and height.
struct ImageShares {
  double x, y, w, h;
};

/// A share of 1/2 is the image's middle, between its two middle pixels.
image_box_t BoxFromShares(const ImageShares& shares, int image_width_px, int image_height_px);

/// What makes a tuple useless, each as "what must be (what was found)": numbers that are not
/// finite, boxes without size, left and right the wrong way round, a distance that is none.
std::vector<std::string> FaultsOf(const StereoTuple& tuple);

/// Tuples in order of flight, then of time; no flight is in two splits.
struct TupleSplits {
  std::vector<StereoTuple> train, val, test;
};

/// Shares of a data set in the paper: 2815 : 541 : 539, in the order of `all`.
TupleSplits SplitAsThePaper(const std::vector<StereoTuple>& all);

}  // namespace windhover
