#include "estimator/yolox_detector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "common/config/at_its_place.h"
#include "estimator/box_alignment.h"
#include "estimator/counterpart_search.h"
#include "estimator/stereo_pairing.h"

namespace windhover {
namespace {

constexpr double kMinScoreAgain = 0.01;

void CheckPair(const cv::Mat& left, const cv::Mat& right) {
  const bool good = left.type() == CV_8UC3 && right.type() == CV_8UC3 && !left.empty() &&
                    left.size() == right.size();
  if (good) return;
  throw std::invalid_argument(fmt::format(
      "the detector needs two 8-bit RGB images of one size (found {} x {} and {} x {} px)",
      left.cols, left.rows, right.cols, right.rows));
}

/// What the second look says of a target of the first, with a score of 0 if it sees none.
ScoredBox Confirmed(const ScoredBox& first, const std::vector<ScoredBox>& seen) {
  ScoredBox best{first.box, 0};
  for (const ScoredBox& box : seen) {
    if (box.score > best.score && OverlapOf(box.box, first.box) >= kMinOverlapAgain) best = box;
  }
  return best;
}

/// Both become as large as their geometric mean: seen at one scale, the network errs alike in both
/// images, and disparity is a difference.
void ShareSize(std::array<image_box_t, 2>* boxes) {
  auto& [left, right] = *boxes;
  left.w_px = right.w_px = std::sqrt(left.w_px * right.w_px);
  left.h_px = right.h_px = std::sqrt(left.h_px * right.h_px);
}

/// Mean box, geometric mean of the scores.
ScoredBox MeanOf(const ScoredBox& a, const ScoredBox& b) {
  ScoredBox mean{a.box, std::sqrt(a.score * b.score)};
  mean.box.x_px = (a.box.x_px + b.box.x_px) / 2;
  mean.box.y_px = (a.box.y_px + b.box.y_px) / 2;
  mean.box.w_px = (a.box.w_px + b.box.w_px) / 2;
  mean.box.h_px = (a.box.h_px + b.box.h_px) / 2;
  return mean;
}

/// Whether both images show one target twice: the second look may have moved to it from two
/// first boxes.
bool IsDouble(const stereo_box_t& box, const std::vector<stereo_box_t>& better) {
  return std::any_of(better.begin(), better.end(), [&](const stereo_box_t& other) {
    return OverlapOf(box.left, other.left) > kMaxOverlap &&
           OverlapOf(box.right, other.right) > kMaxOverlap;
  });
}

std::vector<stereo_box_t> BestFirst(std::vector<stereo_box_t> boxes) {
  std::stable_sort(boxes.begin(), boxes.end(),
                   [](const stereo_box_t& a, const stereo_box_t& b) { return a.score > b.score; });
  std::vector<stereo_box_t> kept;
  for (const stereo_box_t& box : boxes) {
    if (!IsDouble(box, kept)) kept.push_back(box);
  }
  return kept;
}

/// The best box of the first look in one image where no target is found, with a score of 0 if there
/// is none.
ScoredBox BestAlone(const std::vector<ScoredBox>& found, const std::vector<stereo_box_t>& targets,
                    image_box_t stereo_box_t::*eye) {
  for (const ScoredBox& box : found) {
    const bool is_found = std::any_of(targets.begin(), targets.end(), [&](const auto& target) {
      return OverlapOf(box.box, target.*eye) >= kMinOverlapAgain;
    });
    if (!is_found) return box;
  }
  return {};
}

std::filesystem::path FolderOf(const InputFile& card) {
  return std::filesystem::path(card.absolute).parent_path();
}

DetectorCard CardOf(const std::string& name, const InputFile& file) {
  DetectorCard card = ReadDetectorCard(file.absolute);
  if (card.network == name) return card;
  throw ConfigError(fmt::format("{}: network: must be {}, as estimator.detector (found {})",
                                file.absolute, name, card.network));
}

}  // namespace

YoloxDetector::YoloxDetector(const DetectorCard& card, const std::filesystem::path& folder,
                             EngineKind kind)
    : min_score_(card.min_score),
      refiner_margin_(card.refiner_margin),
      detector_(ReadWeights(card.detector, folder), /*batch=*/2, kind) {
  if (card.refiner) refiner_.emplace(ReadWeights(*card.refiner, folder), /*batch=*/2, kind);
}

std::vector<std::vector<ScoredBox>> YoloxDetector::FirstLook(const cv::Mat& left_rgb,
                                                             const cv::Mat& right_rgb,
                                                             double min_score) {
  CheckPair(left_rgb, right_rgb);
  const std::array<cv::Mat, 2> images = {left_rgb, right_rgb};
  return detector_.FindInWhole(images, refiner_ ? kWorthALook : min_score);
}

std::array<ScoredBox, 2> YoloxDetector::Look(const cv::Mat& left_rgb, const cv::Mat& right_rgb,
                                             bool is_one_target,
                                             const std::array<ScoredBox, 2>& found) {
  std::array<image_box_t, 2> around = {found[0].box, found[1].box};
  if (is_one_target) ShareSize(&around);
  const std::array<BoxNetwork::View, 2> views = {
      {{left_rgb, CropWindow(around[0], refiner_margin_, refiner_->input())},
       {right_rgb, CropWindow(around[1], refiner_margin_, refiner_->input())}}};
  const auto seen = refiner_->Find(views, kMinScoreAgain);
  return {Confirmed(found[0], seen[0]), Confirmed(found[1], seen[1])};
}

void YoloxDetector::LookAgain(const cv::Mat& left_rgb, const cv::Mat& right_rgb, bool is_one_target,
                              ScoredBox* left, ScoredBox* right) {
  if (!refiner_) return;
  const auto once = Look(left_rgb, right_rgb, is_one_target, {*left, *right});
  const auto twice = Look(left_rgb, right_rgb, is_one_target, once);
  *left = MeanOf(once[0], twice[0]);
  *right = MeanOf(once[1], twice[1]);
}

std::optional<stereo_box_t> YoloxDetector::Target(const cv::Mat& left_rgb, const cv::Mat& right_rgb,
                                                  ScoredBox left, ScoredBox right) {
  LookAgain(left_rgb, right_rgb, /*is_one_target=*/true, &left, &right);
  stereo_box_t box{};
  box.left = left.box;
  box.right = right.box;
  box.score = std::sqrt(left.score * right.score);
  if (box.score < min_score_) return {};
  if (refiner_) AlignBoxes(left_rgb, right_rgb, &box);
  return box;
}

void YoloxDetector::SearchCounterparts(const cv::Mat& left_rgb, const cv::Mat& right_rgb,
                                       const std::vector<std::vector<ScoredBox>>& found,
                                       std::vector<stereo_box_t>* targets) {
  const std::array<ScoredBox, 2> alone = {BestAlone(found[0], *targets, &stereo_box_t::left),
                                          BestAlone(found[1], *targets, &stereo_box_t::right)};
  if (alone[0].score == 0 && alone[1].score == 0) return;
  const auto [left, right] = Look(left_rgb, right_rgb, /*is_one_target=*/false, alone);
  const auto add = [&](const image_box_t& one, const image_box_t& other) {
    const auto target = Target(left_rgb, right_rgb, {one}, {other});
    if (target && ParallaxAgrees(*target, one.x_px - other.x_px)) targets->push_back(*target);
  };
  if (left.score >= min_score_) add(left.box, FindCounterpart(left_rgb, 0, left.box, right_rgb));
  if (right.score >= min_score_) add(FindCounterpart(right_rgb, 1, right.box, left_rgb), right.box);
}

std::vector<stereo_box_t> YoloxDetector::Detect(const cv::Mat& left_rgb, const cv::Mat& right_rgb) {
  const auto found = FirstLook(left_rgb, right_rgb, min_score_);
  std::vector<stereo_box_t> boxes;
  for (const auto& [i, k] : PairBoxes(found[0], found[1], left_rgb.size())) {
    const auto target = Target(left_rgb, right_rgb, found[0][i], found[1][k]);
    if (target) boxes.push_back(*target);
  }
  if (refiner_) SearchCounterparts(left_rgb, right_rgb, found, &boxes);
  return BestFirst(std::move(boxes));
}

std::vector<std::vector<ScoredBox>> YoloxDetector::DetectEach(const cv::Mat& one_rgb,
                                                              const cv::Mat& other_rgb,
                                                              double min_score) {
  auto found = FirstLook(one_rgb, other_rgb, min_score);
  // The refiner takes two at once: what has no counterpart is looked at beside itself.
  for (std::size_t i = 0; i < std::max(found[0].size(), found[1].size()); ++i) {
    ScoredBox none;
    ScoredBox* one = i < found[0].size() ? &found[0][i] : &none;
    ScoredBox* other = i < found[1].size() ? &found[1][i] : &none;
    LookAgain(one_rgb, other_rgb, /*is_one_target=*/false, one, other);
  }
  for (auto& boxes : found) {
    std::erase_if(boxes, [&](const ScoredBox& box) { return box.score < min_score; });
    boxes = WithoutDoubles(std::move(boxes), kMaxOverlap, kMaxTargets);
  }
  return found;
}

std::unique_ptr<Detector> MakeYoloxDetector(const std::string& name, const InputFile& card) {
  return AtItsPlace(
      card, [&] { return std::make_unique<YoloxDetector>(CardOf(name, card), FolderOf(card)); });
}

void CheckYoloxCard(const std::string& name, const InputFile& card) {
  AtItsPlace(card, [&] {
    const DetectorCard read = CardOf(name, card);
    ReadWeights(read.detector, FolderOf(card));
    if (read.refiner) ReadWeights(*read.refiner, FolderOf(card));
  });
}

}  // namespace windhover
