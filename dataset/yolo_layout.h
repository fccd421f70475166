#pragma once

#include <set>

#include "dataset/dataset_layout.h"

namespace windhover {

/// What YOLO trainers read: images/SPLIT/FLIGHT_TICK_{left,right}.jpg, labels/SPLIT/….txt with
/// "class x y w h" of every target's visible box (an empty file where there is none), data.yaml.
class YoloLayout : public DatasetLayout {
 public:
  explicit YoloLayout(std::filesystem::path folder) : folder_(std::move(folder)) {}

  StereoFiles ImageFiles(const PairId& id) const override;
  void Add(const LabelledPair& pair) override;
  void Finish() override;

 private:
  std::filesystem::path folder_;
  std::set<Split> splits_;
};

}  // namespace windhover
