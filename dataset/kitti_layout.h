#pragma once

#include <map>

#include "dataset/dataset_layout.h"

namespace windhover {

/// KITTI's object benchmark: training/{image_2,image_3}/NNNNNN.png, label_2/NNNNNN.txt (of the left
/// image), calib/NNNNNN.txt, ImageSets/SPLIT.txt. Projections are those of the calibrated rig;
/// images are as the cameras took them, with distortion and not rectified. Types are "UAV".
class KittiLayout : public DatasetLayout {
 public:
  explicit KittiLayout(std::filesystem::path folder) : folder_(std::move(folder)) {}

  StereoFiles ImageFiles(const PairId& id) const override;
  void Add(const LabelledPair& pair) override;
  void Finish() override;

 private:
  std::filesystem::path folder_;
  std::map<Split, std::string> image_sets_;
};

}  // namespace windhover
