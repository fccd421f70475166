#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/run_record.h"

namespace windhover {

/// What a method said of one target in one frame.
struct MethodEstimate {
  double range_m;
  double range_sigma_m;
  int n_stages;
};

/// One target that both cameras had in view in one frame: the unit that every metric counts.
struct TargetFrame {
  Utime utime = 0;
  int observer_id = 0;
  target_annotation_t truth{};
  double reference_m = 0;           ///< d*, as score.reference says.
  std::optional<double> uwb_m;      ///< UWB range, if any.
  std::string detector;             ///< Empty when the frame has no detection message.
  std::optional<stereo_box_t> box;  ///< The detection of this target, if any.
  std::vector<std::optional<MethodEstimate>> estimates;  ///< In order of the scenario's methods.
};

struct TargetFrames {
  std::vector<TargetFrame> frames;  ///< In order of (utime, observer, target).
  int false_detections = 0;         ///< Detections that lie on no target.
  int no_reference = 0;             ///< Frames left out because score.reference has no value.
};

/// Is any part of the target inside both images, and in front of both cameras?
bool InViewOfBoth(const target_annotation_t& target);

/// What distances to the target are scored against, if there is a finite and positive one.
std::optional<double> Reference_m(const target_annotation_t& truth,
                                  const std::optional<double>& uwb_m, ScoreReference reference);

/// For each box of `detections`, the index of its target in `truth`, or nothing.
///
/// A pair may be joined when the left boxes overlap or their centres are closer than the larger
/// side of either; nearest centres are joined first, one box to one target. The right boxes have
/// no say: a box that is matched to the wrong thing in the right image still claims its target,
/// and the error it makes is charged to the method.
std::vector<std::optional<std::size_t>> Associate(const detection_t& detections,
                                                  const annotation_t& truth);

/// Joins truth, detections and estimates of a flight.
TargetFrames CollectTargetFrames(const RunRecord& run);

}  // namespace windhover
