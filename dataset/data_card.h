#pragma once

#include <array>
#include <map>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dataset/dataset_layout.h"

namespace windhover {

struct ExportPlan;

/// What a data set says of itself: dataset.json, README.md, contact_sheet.png (where there are
/// images) and SHA256SUMS of every file, as sha256sum reads it.
class DataCard {
 public:
  explicit DataCard(const ExportPlan& plan);

  /// `image`: the left one, relative to the data set; empty if there is none.
  void Add(const LabelledPair& pair, const std::filesystem::path& image);

  /// The last file, dataset.json, is there when all others are.
  /// @throws std::runtime_error if a file cannot be written or read.
  void Write() const;

 private:
  static constexpr int kDistanceStep_m = 5, kSizeStep_px = 20, kBins = 40, kThumbnails = 24;

  struct Counts {
    int flights = 0, pairs = 0, targets = 0, truncated = 0, occluded = 0;
    std::array<int, kBins> by_distance{}, by_width{};  ///< The last bin has all beyond.
  };

  void CountTargets(const LabelledPair& pair, Counts* counts) const;
  void AddThumbnail(const LabelledPair& pair, const std::filesystem::path& image);
  void WriteContactSheet() const;
  std::string Readme() const;
  std::string Json() const;

  const ExportPlan& plan_;
  int n_pairs_ = 0;  ///< Planned.
  std::map<Split, Counts> counts_;
  std::vector<cv::Mat> thumbnails_;
};

}  // namespace windhover
