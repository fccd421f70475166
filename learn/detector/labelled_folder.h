#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "learn/detector/detector_sample.h"
#include "learn/detector/picture_scene.h"
#include "learn/detector/replay_source.h"

namespace windhover {

/// A picture of a folder and the aircraft in it.
struct LabelledFile {
  std::filesystem::path file;
  cv::Mat rgb;
  std::vector<image_box_t> boxes;  ///< px.
};

/// Reads labelled pictures in YOLO's layout, as `windhover export --format yolo` writes it:
/// images/**.{jpg,jpeg,png} and, for each, labels/** of the same name ending in .txt, a line
/// "class x y w h" for each aircraft: centre and size in shares of the image. An empty file: there
/// is none. In order of names, at most `most` of them, spread evenly; every label file is checked.
/// @throws ConfigError listing everything wrong, each as `file: …` or `file:line: …`.
std::vector<LabelledFile> ReadLabelledFolder(const std::filesystem::path& folder,
                                             std::size_t most = 400);

/// The picture once for each aircraft in it, the others painted over in grey; or once without.
std::vector<LabelledPicture> PicturesOf(const LabelledFile& labelled);

/// Endless training on the same few pictures, for fine-tuning of the first or second network.
/// @pre not empty
std::unique_ptr<DetectorSampleSource> MakeFolderSource(const std::vector<LabelledFile>& files,
                                                       bool is_refinement, ReplayConfig replay);

/// Batches of two sources joined: the share of `own`, one picture at least, comes first, the rest
/// is of `other`, so that what was learned before is not forgotten.
std::unique_ptr<DetectorSampleSource> Mixed(std::unique_ptr<DetectorSampleSource> own,
                                            std::unique_ptr<DetectorSampleSource> other,
                                            double share);

}  // namespace windhover
