#pragma once

#include <filesystem>

#include "common/config/fields.h"
#include "learn/stereo_tuple.h"

namespace windhover {

/// Whose boxes of a data set are taken: those of a detector, or those that people drew.
enum class UavdeBoxes { kDetected, kLabelled };
template <>
inline constexpr EnumNames<UavdeBoxes> kEnumNames<UavdeBoxes>{{UavdeBoxes::kDetected, "detected"},
                                                              {UavdeBoxes::kLabelled, "labelled"}};

struct UavdeFolder {
  std::filesystem::path folder = {};  ///< Holds `data`, or is it.
  UavdeBoxes boxes = UavdeBoxes::kDetected;
  int image_width_px = 1280, image_height_px = 720;  ///< Boxes are shares of them.
  double frame_rate_hz = 10;  ///< Times follow from the numbers of frames, a count at this rate.
};

/// Reads the texts of a data set in UAVDE's layout (dataset/uavde_layout.h): of each split that is
/// there the frames of `SPLIT_no_prefix.txt`, their distances in `annotations.csv` (and exact ones,
/// if `annotations_exact.csv` has any), and boxes: the last row of a file of detections, as their
/// code does, or the largest of a file of labels. Frames of one prefix are a flight; their name
/// ends in their number. A single split is split as in the paper, in its order.
/// @throws ConfigError if no split is there; `FILE:LINE: …` for all frames without a distance or
/// boxes, and for what FaultsOf() finds.
TupleSplits ReadUavdeTexts(const UavdeFolder& data);

}  // namespace windhover
