#pragma once

#include <filesystem>
#include <string>

#include "learn/stereo_tuple.h"

namespace windhover {

/// The columns of a file of tuples, in px and m; one line a detection, in order of split, flight
/// and time. `split` is 0 for train, 1 for val, 2 for test.
inline constexpr const char* kTupleColumns =
    "split,flight,utime_us,x_left_px,y_left_px,w_left_px,h_left_px,"
    "x_right_px,y_right_px,w_right_px,h_right_px,range_m,range_true_m";

/// @throws std::runtime_error if the file cannot be written.
void WriteTuples(const TupleSplits& tuples, const std::string& file);

/// Reads what WriteTuples() wrote; or lines of nine columns, x, y, w, h of the left box, then of
/// the right one, centres and sizes in shares of an image of `image_width_px` by
/// `image_height_px`, then the distance in m; or UAVDE's own files (learn/uavde_file.h): one .npy,
/// or a folder with one a split. What has no splits is split as in the paper, in its order.
/// @throws ConfigError `FILE:LINE: …` for numbers that are not finite, boxes without size, left
/// and right the wrong way round, distances that are none, wrong columns, and splits that are
/// empty; as ReadUavdeFile() for UAVDE's.
TupleSplits ReadTuples(const std::filesystem::path& file, int image_width_px, int image_height_px);

}  // namespace windhover
