#pragma once

#include <span>
#include <vector>

#include "lcmtypes/image_box_t.hpp"
#include "network/layer_table.h"

namespace windhover {

struct ScoredBox {
  image_box_t box{};  ///< px of the network's input.
  double score = 0;   ///< 0..1
};

/// What a YOLOX says of one image at one stride (network/yolox.h): 6 × height × width numbers.
struct YoloxLevel {
  std::span<const float> values;
  int height = 0, width = 0, stride = 0;
};

/// Boxes with at least `min_score`, in the order of their cells, with centres inside the input and
/// sizes up to four times the input's.
/// @throws std::runtime_error if a number is not finite.
std::vector<ScoredBox> DecodeBoxes(std::span<const YoloxLevel> levels, double min_score);

/// Intersection over union.
double OverlapOf(const image_box_t& a, const image_box_t& b);

/// Boxes from the best on, without those that overlap a better one by more than `max_overlap`;
/// `most` at most. Of equal scores the one that was given first is the better.
std::vector<ScoredBox> WithoutDoubles(std::vector<ScoredBox> boxes, double max_overlap,
                                      std::size_t most);

}  // namespace windhover
