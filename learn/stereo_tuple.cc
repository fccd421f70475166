#include "learn/stereo_tuple.h"

#include <cmath>
#include <cstddef>

#include <fmt/format.h>

namespace windhover {

image_box_t BoxFromShares(const ImageShares& shares, int image_width_px, int image_height_px) {
  image_box_t box{};
  box.x_px = shares.x * image_width_px - 0.5;
  box.y_px = shares.y * image_height_px - 0.5;
  box.w_px = shares.w * image_width_px;
  box.h_px = shares.h * image_height_px;
  return box;
}

std::vector<std::string> FaultsOf(const StereoTuple& tuple) {
  const image_box_t &left = tuple.box.left, &right = tuple.box.right;
  for (const double number : {left.x_px, left.y_px, left.w_px, left.h_px, right.x_px, right.y_px,
                              right.w_px, right.h_px, tuple.range_m}) {
    if (!std::isfinite(number)) return {fmt::format("numbers must be finite (found {:g})", number)};
  }
  std::vector<std::string> faults;
  for (const double size : {left.w_px, left.h_px, right.w_px, right.h_px}) {
    if (size > 0) continue;
    faults.push_back(fmt::format("sizes of boxes must be above 0 (found {:g})", size));
    break;
  }
  if (!(left.x_px > right.x_px)) {
    faults.push_back(
        fmt::format("the left box must be right of the right one: are they the wrong way round? "
                    "(found a disparity of {:g} px)",
                    left.x_px - right.x_px));
  }
  if (!(tuple.range_m > 0)) {
    faults.push_back(fmt::format("distance must be above 0 (found {:g})", tuple.range_m));
  }
  return faults;
}

TupleSplits SplitAsThePaper(const std::vector<StereoTuple>& all) {
  const auto n = static_cast<std::ptrdiff_t>(all.size());
  const auto train = n * 2815 / 3895, val = n * (2815 + 541) / 3895;
  return {{all.begin(), all.begin() + train},
          {all.begin() + train, all.begin() + val},
          {all.begin() + val, all.end()}};
}

}  // namespace windhover
