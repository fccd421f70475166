#pragma once

#include <string>
#include <vector>

#include "network/layer_table.h"

namespace windhover {

/// A network of the YOLOX family: which table, and for which images it was made.
///
/// Its input is 1 × 3 × height × width, RGB, value / 255. For each stride it gives out 6 ×
/// (height / stride) × (width / stride): reg (x, y, width, height), obj, cls, all raw. For the cell
/// in column i and row j the box has its centre at ((i + reg_x), (j + reg_y)) · stride - 0.5 px, in
/// pixels of the input ((0, 0) is the centre of the first pixel), and the size
/// exp(reg_w), exp(reg_h) · stride; its score is sigmoid(obj) · sigmoid(cls).
/// Source: Ge, Liu, Wang, Li, Sun: "YOLOX: Exceeding YOLO Series in 2021", arXiv:2107.08430; the
/// layers are those of its public description.
struct YoloxNetwork {
  std::string name;
  int height = 0, width = 0;
  std::vector<int> strides;  ///< In the order of the table's outputs.
  LayerTable table;
};

inline const std::vector<std::string> kYoloxNetworks = {"yolox_nano", "yolox_small",
                                                        "yolox_refine"};

/// yolox_nano: CSPDarknet 0.33/0.25 of depthwise convolutions with SPP, PAFPN and a decoupled
/// anchor-free head, SiLU; 896,754 parameters, images of 352 × 192. yolox_small: the same of
/// plain convolutions at half the width and with one in each branch of the head, ReLU.
/// yolox_refine: as small, but two in each branch, for the 128 × 128 images around a first
/// detection.
/// @throws std::invalid_argument for a name that is none of kYoloxNetworks.
YoloxNetwork MakeYolox(const std::string& name);

}  // namespace windhover
