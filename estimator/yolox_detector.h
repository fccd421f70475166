#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/config/fields.h"
#include "estimator/detector.h"
#include "network/box_network.h"
#include "network/detector_card.h"

namespace windhover {

/// Finds aircraft by what was learned: a network sees both whole images at a quarter of their
/// resolution. What it finds in both, one beside the other, a second network sees at full
/// resolution, a square around each box, and says again whether there is one and where its box is;
/// then once more around that, at one scale in both images. Boxes are the mean of these two looks,
/// aligned with each other by their pixels (AlignBoxes), scores the geometric mean of the looks and
/// of both images. The best box that the first finds in one image alone, if the second confirms it,
/// is searched for in the other (FindCounterpart), and both are looked at in the same way. What one
/// image alone shows is no detection.
class YoloxDetector final : public Detector {
 public:
  /// @param folder of the card, where its weights are.
  /// @throws ConfigError as ReadWeights().
  YoloxDetector(const DetectorCard& card, const std::filesystem::path& folder,
                EngineKind kind = EngineKind::kOneDnn);

  /// @throws std::invalid_argument if the images are not 8-bit RGB of one size.
  /// @throws std::runtime_error if a network gives numbers that are not finite.
  std::vector<stereo_box_t> Detect(const cv::Mat& left_rgb, const cv::Mat& right_rgb) override;

  /// The same of two images for themselves, whatever the other shows, best first: what the
  /// detector is evaluated by. @param min_score instead of the card's.
  std::vector<std::vector<ScoredBox>> DetectEach(const cv::Mat& one_rgb, const cv::Mat& other_rgb,
                                                 double min_score);

 private:
  std::vector<std::vector<ScoredBox>> FirstLook(const cv::Mat& left_rgb, const cv::Mat& right_rgb,
                                                double min_score);
  std::array<ScoredBox, 2> Look(const cv::Mat& left_rgb, const cv::Mat& right_rgb,
                                bool is_one_target, const std::array<ScoredBox, 2>& found);
  void LookAgain(const cv::Mat& left_rgb, const cv::Mat& right_rgb, bool is_one_target,
                 ScoredBox* left, ScoredBox* right);
  std::optional<stereo_box_t> Target(const cv::Mat& left_rgb, const cv::Mat& right_rgb,
                                     ScoredBox left, ScoredBox right);
  void SearchCounterparts(const cv::Mat& left_rgb, const cv::Mat& right_rgb,
                          const std::vector<std::vector<ScoredBox>>& found,
                          std::vector<stereo_box_t>* targets);

  double min_score_, refiner_margin_;
  BoxNetwork detector_;
  std::optional<BoxNetwork> refiner_;
};

/// The detector of a scenario: its card must be of the network `name`. Mistakes of the card say
/// where the scenario names it. @throws ConfigError
std::unique_ptr<Detector> MakeYoloxDetector(const std::string& name, const InputFile& card);

/// Reads all that MakeYoloxDetector() would. @throws ConfigError as that does.
void CheckYoloxCard(const std::string& name, const InputFile& card);

}  // namespace windhover
