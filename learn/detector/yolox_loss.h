#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lcmtypes/image_box_t.hpp"

namespace windhover {

/// What a network gives out for one level of a batch: images × 6 × rows × columns, raw
/// (network/yolox.h says what the six mean).
struct LevelOutput {
  int stride = 0, rows = 0, columns = 0;
  std::span<const float> raw;
  std::span<float> gradient;  ///< Of the loss, written; as large as `raw`.
};

/// A cell's prediction for one image.
struct CellPrediction {
  int stride, row, column;
  double reg_x, reg_y, reg_w, reg_h, obj, cls;

  image_box_t Box() const;
};

/// Indices of the predictions that learn the target: among the cells whose centre is in the box or
/// within 2.5 strides of its centre, the k cheapest, where k is the sum of the ten best overlaps.
/// Source: YOLOX, section 2.1 (SimOTA); cost = class + 3 · overlap + 10⁵ unless inside both.
std::vector<int> AssignSimOta(std::span<const CellPrediction> cells, const image_box_t& target);

/// Means over the assigned cells of a batch.
struct YoloxLossParts {
  double box = 0;     ///< 5 (1 - overlap²)
  double offset = 0;  ///< Absolute errors of the raw box.
  double objectness = 0, cls = 0;
  int n_assigned = 0;
  double Total() const { return box + offset + objectness + cls; }
};

/// The loss of a batch of images with one target or none, and its gradient by the raw outputs.
/// Source: YOLOX, section 2.1; the class learns the overlap.
YoloxLossParts YoloxLoss(std::span<const LevelOutput> levels,
                         std::span<const std::optional<image_box_t>> targets);

}  // namespace windhover
