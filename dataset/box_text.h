#pragma once

#include <string>

#include "dataset/dataset_layout.h"

namespace windhover {

/// Edges of a box in px; (0, 0) is the corner of the image, not the middle of its first pixel.
struct BoxEdges {
  double left_px, top_px, right_px, bottom_px;
};

BoxEdges EdgesOf(const image_box_t& box);

/// "x y w h" of centre and size in shares of an image, as YOLO and UAVDE have them.
std::string BoxInShares(const image_box_t& box, int width_px, int height_px);

/// A line "0 x y w h" for each target of which the camera `side` sees something.
std::string VisibleBoxes(const LabelledPair& pair, target_view_t target_annotation_t::*side);

}  // namespace windhover
