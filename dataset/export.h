#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "dataset/draw_images.h"

namespace windhover {

struct ExportPlan {
  FlightSource source;
  DatasetFormat format = DatasetFormat::kUavde;
  ImageOptions images;
  std::filesystem::path folder;
  std::string scenario;  ///< What the data card calls the source.
  std::string command;   ///< Likewise, how to make the same again.
  std::string version;   ///< Of windhover.
};

/// Writes a data set: images, then labels and lists, then the data card (dataset/data_card.h). The
/// card is there when all is. What is unfinished has a folder `.export`, and another call with the
/// same plan goes on there, to the same bytes, on any number of threads.
/// `on_progress(done, total)` counts pairs and says whether to go on. @return whether all is done.
/// @throws ConfigError if the folder holds anything else, or the format cannot express the rig;
/// std::runtime_error if a file cannot be written.
bool Export(const ExportPlan& plan, const std::function<bool(int done, int total)>& on_progress);

}  // namespace windhover
