#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "eval/run_record.h"
#include "tests/support/image_box.h"

namespace windhover {

inline target_view_t View(const image_box_t& box) {
  target_view_t view{};
  view.in_front = 1;
  view.visible = view.full = box;
  return view;
}

/// A target `depth_m` straight ahead, whose boxes are 40 px wide in both images.
inline target_annotation_t TargetAhead(int id, double depth_m, double left_x_px = 640) {
  target_annotation_t target{};
  target.target_id = id;
  target.p_RT_m[2] = depth_m;
  target.range_m = target.depth_m = depth_m;
  target.left = View(Box(left_x_px, 360, 40, 20));
  target.right = View(Box(left_x_px - 50, 360, 40, 20));
  return target;
}

inline stereo_box_t StereoBox(const image_box_t& left, const image_box_t& right) {
  stereo_box_t box{};
  box.left = left;
  box.right = right;
  box.score = 1;
  return box;
}

inline range_estimate_t Estimate(int detection, const std::string& method, double range_m,
                                 double sigma_m) {
  range_estimate_t estimate{};
  estimate.detection_index = detection;
  estimate.method = method;
  estimate.status = range_estimate_t::STATUS_OK;
  estimate.range_m = range_m;
  estimate.range_sigma_m = sigma_m;
  return estimate;
}

/// A frame of aircraft 0 at `utime` that sees `target` where it is and estimates `range_m`.
inline ObserverFrame SeenFrame(Utime utime, const target_annotation_t& target, double range_m,
                               double sigma_m = 1) {
  ObserverFrame frame;
  frame.utime = utime;
  frame.truth.utime = utime;
  frame.truth.targets = {target};
  frame.truth.n_targets = 1;
  frame.detections = detection_t{};
  frame.detections->detector = "test";
  frame.detections->boxes = {StereoBox(target.left.visible, target.right.visible)};
  frame.detections->n_boxes = 1;
  frame.ranges = range_t{};
  frame.ranges->estimates = {Estimate(0, "baseline", range_m, sigma_m)};
  frame.ranges->n_estimates = 1;
  return frame;
}

/// The same frame, in which nothing was detected.
inline ObserverFrame MissedFrame(Utime utime, const target_annotation_t& target) {
  ObserverFrame frame = SeenFrame(utime, target, 1);
  frame.detections->boxes.clear();
  frame.detections->n_boxes = 0;
  frame.ranges->estimates.clear();
  frame.ranges->n_estimates = 0;
  return frame;
}

/// A valid flight of 10 Hz with the given frames.
inline RunRecord Flight(std::vector<ObserverFrame> frames) {
  RunRecord run;
  run.scenario.description = "a flight made for a test";
  run.scenario.frame_rate_hz = 10;
  run.scenario.estimator.methods = {"baseline"};
  run.valid = true;
  run.version = "0.1.0";
  run.frames = std::move(frames);
  return run;
}

}  // namespace windhover
