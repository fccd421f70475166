#include "estimator/counterpart_search.h"

#include <cmath>

#include <opencv2/imgproc.hpp>

#include "estimator/stereo_pairing.h"
#include "network/detector_input.h"

namespace windhover {
namespace {

// A second look corrects what the search errs by.
constexpr double kLongestSide_px = 32;

/// Where it may be in the other image.
InputWindow Strip(const InputWindow& sought, int eye, const image_box_t& box, cv::Size image) {
  const PairingLimits limits;
  const int against = sought.Pixels(limits.against_parallax * image.width);
  const int along = sought.Pixels(eye == 0 ? box.x_px : image.width - box.x_px);
  const int rows = sought.Pixels(limits.rows_of_image * image.height);
  InputWindow window = sought;
  window.size += cv::Size(against + along, 2 * rows);
  window.left_px -= sought.scale * (eye == 0 ? along : against);
  window.top_px -= sought.scale * rows;
  return window;
}

}  // namespace

image_box_t FindCounterpart(const cv::Mat& rgb, int eye, const image_box_t& box,
                            const cv::Mat& other_rgb) {
  const InputWindow sought = ReducedWindow(box, kLongestSide_px);
  const InputWindow strip = Strip(sought, eye, box, rgb.size());
  cv::Mat likeness;
  cv::matchTemplate(SeenThrough(strip, other_rgb), SeenThrough(sought, rgb), likeness,
                    cv::TM_CCOEFF_NORMED);
  cv::Point best;
  cv::minMaxLoc(likeness, nullptr, nullptr, nullptr, &best);
  image_box_t found = box;
  found.x_px += strip.left_px + strip.scale * best.x - sought.left_px;
  found.y_px += strip.top_px + strip.scale * best.y - sought.top_px;
  return found;
}

bool ParallaxAgrees(const stereo_box_t& boxes, double parallax_px) {
  const double width_px = std::sqrt(boxes.left.w_px * boxes.right.w_px);
  const double error_px = boxes.left.x_px - boxes.right.x_px - parallax_px;
  return std::abs(error_px) <= 2 * width_px / kLongestSide_px;
}

}  // namespace windhover
