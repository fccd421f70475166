#pragma once

#include <filesystem>
#include <vector>

#include "learn/stereo_tuple.h"

namespace windhover {

/// Reads boxes and distances as UAVDE keeps them, `data/<split>.npy`: what NumPy's save() makes of
/// a list of dictionaries. `left` and `right`: arrays of detections, best last, with rows class,
/// x, y, w, h (and confidence), centres and sizes in shares of an image of `image_width_px` by
/// `image_height_px`; `dist`: metres, an array of no dimension or a float. Entries come in the
/// file's order; `utime` and `flight` stay 0, since frames are not evenly spaced.
/// @throws ConfigError `FILE: …` for a file that is none, too large or cut short (with the byte),
/// and for all entries (with number and `file_id`) that have wrong shapes, numbers that are not
/// finite, boxes without size, left and right the wrong way round, or no distance.
std::vector<StereoTuple> ReadUavdeFile(const std::filesystem::path& file, int image_width_px,
                                       int image_height_px);

/// Reads `folder`/train.npy, val.npy and test.npy.
/// @throws as ReadUavdeFile(), and for an empty split.
TupleSplits ReadUavdeFolder(const std::filesystem::path& folder, int image_width_px,
                            int image_height_px);

}  // namespace windhover
