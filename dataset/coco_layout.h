#pragma once

#include <map>

#include "common/file/whole_file.h"
#include "dataset/dataset_layout.h"

namespace windhover {

/// Run lengths of a mask in COCO's order: down the columns, from left to right, first those that
/// are not of it. `mask` has `width · height` bytes in rows; those that equal `label` are.
std::vector<int> RunLengths(const std::vector<std::uint8_t>& mask, int width_px, int height_px,
                            std::uint8_t label);

/// COCO: SPLIT/FLIGHT_TICK_{left,right}.jpg and annotations/instances_SPLIT.json with boxes of what
/// is visible, masks of bodies (uncompressed run lengths) and distances under `attributes`.
class CocoLayout : public DatasetLayout {
 public:
  explicit CocoLayout(std::filesystem::path folder) : folder_(std::move(folder)) {}

  StereoFiles ImageFiles(const PairId& id) const override;
  void Add(const LabelledPair& pair) override;
  void Finish() override;

 private:
  /// A file for one split: images go into it at once, annotations, which follow, wait beside it.
  struct Lists {
    explicit Lists(const std::filesystem::path& file);
    std::filesystem::path waiting_file;
    WholeFile json;
    std::ofstream waiting;
    std::int64_t n_images = 0, n_annotations = 0;
  };
  static void AddEye(const LabelledPair& pair, bool is_left, const std::filesystem::path& image,
                     const std::vector<std::uint8_t>& mask, Lists* lists);
  static void Complete(Lists* lists);

  std::filesystem::path folder_;
  std::map<Split, Lists> lists_;
};

}  // namespace windhover
