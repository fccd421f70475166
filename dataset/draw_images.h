#pragma once

#include <functional>
#include <map>

#include "dataset/dataset_layout.h"

namespace windhover {

struct ImageOptions {
  int jpeg_quality = 95;
  bool clean_twins = false;  ///< Also each pair without noise and blur, under clean/.
  bool dense = false;        ///< Also depth, disparity and masks, in a folder of dense/ a pair.
  int threads = 1;           ///< Changes no bit.
};

/// The scenario with every exposure a moment in its middle and no noise: images of it have the
/// labels, depths and masks of the scenario's own.
Scenario CleanTwin(Scenario scenario);

/// Draws the images of a data set into `folder`, each put there when it is whole, and keeps
/// annotations of those that are drawn in `notes`. Pairs that `notes` has already are left alone,
/// so that an interrupted export goes on where it was.
/// `on_progress(done, total)` says whether to go on. @return whether all are drawn.
/// @throws std::runtime_error if an image cannot be written, or a run's frame, drawn again, is not
/// what its log says it was.
bool DrawImages(const FlightSource& source, const DatasetLayout& layout,
                const ImageOptions& options, const std::filesystem::path& folder,
                const std::filesystem::path& notes,
                const std::function<bool(int done, int total)>& on_progress);

/// The annotations that `notes` has of a flight, by time.
std::map<Utime, annotation_t> ReadNotes(const std::filesystem::path& notes,
                                        const std::string& flight);

}  // namespace windhover
