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

}  // namespace windhover
