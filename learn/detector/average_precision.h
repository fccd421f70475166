#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "lcmtypes/image_box_t.hpp"
#include "network/box_decoding.h"

namespace windhover {

/// An aircraft that is to be found in an image.
struct LabelledBox {
  image_box_t box{};
  double range_m = 0;
  bool counts = true;  ///< Otherwise finding it is neither right nor wrong: hardly to be seen.
};

/// What is in an image, and what a detector found there; px of the image.
struct ImageResult {
  std::vector<LabelledBox> labels;
  std::vector<ScoredBox> found;
};

/// Aircraft between whose edges are so many px: what lies outside counts neither way.
struct WidthRange {
  double least_px = 0, below_px = std::numeric_limits<double>::infinity();
};

/// Average precision as COCO defines it. Of each image the 100 best detections, best first, each
/// take the label that overlaps them most, of those not taken by a better one, if their
/// intersection over union is at least `overlap`; labels that count come before others. Detections
/// that took none are wrong, unless their own width is outside `widths`. Precision is made to fall
/// with recall, by the best precision at any higher recall, and averaged over recalls of 0, 0.01, …
/// 1; it is 0 at recalls that are not reached. Nothing, if no label counts.
/// Source: T.-Y. Lin et al., "Microsoft COCO", arXiv 1405.0312, and the definition at
/// cocodataset.org. Here ranges are of widths, not of areas.
std::optional<double> AveragePrecision(const std::vector<ImageResult>& images, double overlap,
                                       const WidthRange& widths = {});

/// The mean of AveragePrecision at overlaps of 0.5, 0.55, … 0.95: "AP50:95".
std::optional<double> MeanAveragePrecision(const std::vector<ImageResult>& images,
                                           const WidthRange& widths = {});

/// Which of the labels of an image that count are found, with at least `min_score`: of each its
/// detection, matched as above at an overlap of 0.5.
std::vector<std::optional<ScoredBox>> Matches(const ImageResult& image, double min_score);

/// Of the aircraft in a range of distances.
struct RecallBin {
  double nearest_m, farthest_m;
  int n = 0, n_found = 0;

  double Recall() const { return n > 0 ? 1.0 * n_found / n : 0; }
};

/// Recall between each of `edges_m` (ascending) and the next, of labels that count.
std::vector<RecallBin> RecallByDistance(const std::vector<ImageResult>& images,
                                        const std::vector<double>& edges_m, double min_score);

/// Detections of at least `min_score` that took no label.
int CountFalseDetections(const std::vector<ImageResult>& images, double min_score);

/// Errors of the boxes of one aircraft in both cameras, found minus label, px.
struct StereoBoxError {
  image_box_t left{}, right{};  ///< Of centre and size.
  double width_px = 0;          ///< Of the label, mean of both.
  double range_m = 0;
};

/// Of every aircraft that counts and is found in both images of a pair. `left` and `right` list the
/// aircraft in the same order.
std::vector<StereoBoxError> StereoBoxErrors(const ImageResult& left, const ImageResult& right,
                                            double min_score);

}  // namespace windhover
