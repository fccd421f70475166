#pragma once

#include <fstream>
#include <map>

#include "dataset/dataset_layout.h"
#include "dataset/npy_writer.h"

namespace windhover {

/// The layout that the authors' code of UAVDE reads:
///
///     data/SPLIT/image/PREFIX-{Left,Right}-N.jpg
///     data/SPLIT/label/PREFIX-{Left,Right}-N.txt                      class x y w h
///     data/SPLIT/inference/detected_labels/PREFIX-{Left,Right}-N.txt  the same and confidence
///     data/SPLIT/annotations.csv          distance by left image, as score.reference has it
///     data/SPLIT/annotations_exact.csv    the same, true, from the middle of the baseline
///     data/SPLIT_no_prefix.txt, data/SPLIT.npy
///
/// Lists have the pairs in which the nearest target that both cameras see was detected and has a
/// distance: their code takes no others. Boxes are shares of the image; their rows rise with the
/// confidence, the last one counts.
class UavdeLayout : public DatasetLayout {
 public:
  explicit UavdeLayout(std::filesystem::path folder) : folder_(std::move(folder)) {}

  StereoFiles ImageFiles(const PairId& id) const override;
  void Add(const LabelledPair& pair) override;
  void Finish() override;

 private:
  struct Lists {
    explicit Lists(const std::filesystem::path& folder, const std::string& split);
    WholeFile distances, exact, ids;
    UavdeNpyWriter tuples;
  };

  std::filesystem::path folder_;
  std::map<Split, Lists> lists_;
};

}  // namespace windhover
