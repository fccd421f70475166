#pragma once

#include <filesystem>

#include "render/dense_labels.h"

namespace windhover {

/// Writes depth_left.png, depth_right.png (Z, m) and disparity.png (px) as KITTI keeps them, 16 bit
/// of 1/256 with 0 where there is none and at most 255.996; mask_left.png and mask_right.png (8
/// bit, DenseLabels::View::mask). Source: KITTI's development kits for depth and stereo (Uhrig et
/// al., 3DV 2017; Menze & Geiger, CVPR 2015). @throws std::runtime_error if a file cannot be
/// written.
void WriteDensePngs(const DenseLabels& labels, const std::filesystem::path& folder);

}  // namespace windhover
