#include "eval/samples.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace windhover {
namespace {

const image_box_t& SeenBox(const target_view_t& view) {
  return view.visible.w_px > 0 ? view.visible : view.full;
}

bool Overlap(const image_box_t& a, const image_box_t& b) {
  return 2 * std::abs(a.x_px - b.x_px) < a.w_px + b.w_px &&
         2 * std::abs(a.y_px - b.y_px) < a.h_px + b.h_px;
}

double CentreDistance_px(const image_box_t& a, const image_box_t& b) {
  return std::hypot(a.x_px - b.x_px, a.y_px - b.y_px);
}

bool MayBelong(const image_box_t& detected, const image_box_t& truth) {
  const double reach_px = std::max({detected.w_px, detected.h_px, truth.w_px, truth.h_px});
  return Overlap(detected, truth) || CentreDistance_px(detected, truth) < reach_px;
}

std::optional<MethodEstimate> EstimateOf(const ObserverFrame& frame, std::size_t detection,
                                         const std::string& method) {
  if (!frame.ranges) return std::nullopt;
  for (const range_estimate_t& estimate : frame.ranges->estimates) {
    if (estimate.detection_index != static_cast<int>(detection) || estimate.method != method) {
      continue;
    }
    // A range that cannot be one is no estimate, whatever its status says.
    if (estimate.status != range_estimate_t::STATUS_OK || !std::isfinite(estimate.range_m)) break;
    return MethodEstimate{estimate.range_m, estimate.range_sigma_m, estimate.n_stages};
  }
  return std::nullopt;
}

TargetFrame JoinTarget(const RunRecord& run, const ObserverFrame& frame,
                       const target_annotation_t& truth, std::optional<std::size_t> detection) {
  TargetFrame joined;
  joined.utime = frame.utime;
  joined.observer_id = frame.observer_id;
  joined.truth = truth;
  const auto uwb = frame.uwb_m.find(truth.target_id);
  if (uwb != frame.uwb_m.end()) joined.uwb_m = uwb->second;
  if (frame.detections) joined.detector = frame.detections->detector;
  if (detection) joined.box = frame.detections->boxes[*detection];
  for (const std::string& method : run.scenario.estimator.methods) {
    joined.estimates.push_back(detection ? EstimateOf(frame, *detection, method) : std::nullopt);
  }
  return joined;
}

void CollectFrame(const RunRecord& run, const ObserverFrame& frame, TargetFrames* out) {
  std::vector<std::optional<std::size_t>> detection_of(frame.truth.targets.size());
  if (frame.detections) {
    const auto target_of = Associate(*frame.detections, frame.truth);
    for (std::size_t i = 0; i < target_of.size(); ++i) {
      if (target_of[i]) {
        detection_of[*target_of[i]] = i;
      } else {
        ++out->false_detections;
      }
    }
  }
  for (std::size_t i = 0; i < frame.truth.targets.size(); ++i) {
    if (!InViewOfBoth(frame.truth.targets[i])) continue;
    TargetFrame joined = JoinTarget(run, frame, frame.truth.targets[i], detection_of[i]);
    const auto reference_m = Reference_m(joined.truth, joined.uwb_m, run.scenario.score.reference);
    if (reference_m) {
      joined.reference_m = *reference_m;
      out->frames.push_back(std::move(joined));
    } else {
      ++out->no_reference;
    }
  }
}

}  // namespace

bool InViewOfBoth(const target_annotation_t& target) {
  for (const target_view_t* view : {&target.left, &target.right}) {
    if (!view->in_front || view->truncation >= 1) return false;
  }
  return true;
}

std::vector<std::optional<std::size_t>> Associate(const detection_t& detections,
                                                  const annotation_t& truth) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < detections.boxes.size(); ++i) {
    for (std::size_t j = 0; j < truth.targets.size(); ++j) {
      if (!truth.targets[j].left.in_front) continue;
      const image_box_t& seen = SeenBox(truth.targets[j].left);
      if (MayBelong(detections.boxes[i].left, seen)) {
        pairs.emplace_back(CentreDistance_px(detections.boxes[i].left, seen), i, j);
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<std::optional<std::size_t>> target_of(detections.boxes.size());
  std::vector<bool> taken(truth.targets.size());
  for (const auto& [distance_px, i, j] : pairs) {
    if (target_of[i] || taken[j]) continue;
    target_of[i] = j;
    taken[j] = true;
  }
  return target_of;
}

std::optional<double> Reference_m(const target_annotation_t& truth,
                                  const std::optional<double>& uwb_m, ScoreReference reference) {
  std::optional<double> reference_m;
  switch (reference) {
    case ScoreReference::kRange:
      reference_m = truth.range_m;
      break;
    case ScoreReference::kDepth:
      reference_m = truth.depth_m;
      break;
    case ScoreReference::kUwb:
      reference_m = uwb_m;
      break;
  }
  if (!reference_m || !std::isfinite(*reference_m) || *reference_m <= 0) return std::nullopt;
  return reference_m;
}

TargetFrames CollectTargetFrames(const RunRecord& run) {
  TargetFrames out;
  for (const ObserverFrame& frame : run.frames) CollectFrame(run, frame, &out);
  return out;
}

}  // namespace windhover
