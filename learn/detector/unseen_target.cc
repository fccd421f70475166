#include "learn/detector/unseen_target.h"

#include <memory>
#include <optional>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "common/file/whole_file.h"
#include "common/image/image_file.h"
#include "estimator/range_estimator.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEyes[] = {"left", "right"};

std::string NameOf(std::size_t pair, std::size_t eye) {
  return fmt::format("{:03}_{}", pair, kEyes[eye]);
}

std::string LabelsText(const std::vector<LabelledBox>& labels, const cv::Size& size) {
  std::string text;
  for (const LabelledBox& label : labels) {
    text += fmt::format("0 {:.7f} {:.7f} {:.7f} {:.7f}\n", (label.box.x_px + 0.5) / size.width,
                        (label.box.y_px + 0.5) / size.height, label.box.w_px / size.width,
                        label.box.h_px / size.height);
  }
  return text;
}

std::vector<std::unique_ptr<RangeEstimator>> EstimatorsOf(const Scenario& base,
                                                          const std::vector<TrialMethod>& methods) {
  std::vector<std::unique_ptr<RangeEstimator>> estimators;
  for (const TrialMethod& method : methods) {
    estimators.push_back(MakeRangeEstimator(method.method, ConfigFor(method, base.ForAircraft())));
  }
  return estimators;
}

std::optional<stereo_box_t> BoxOf(const TriedPair& pair, BoxSource source) {
  if (source == BoxSource::kBest) {
    if (pair.detections.empty()) return std::nullopt;
    return pair.detections.front();
  }
  stereo_box_t box{};
  box.left = pair.result.eyes[0].labels.front().box;
  box.right = pair.result.eyes[1].labels.front().box;
  box.score = 1;
  return box;
}

}  // namespace

PictureConfig TrialPicturesOf(TargetKind kind, std::uint64_t seed) {
  PictureConfig pictures = HeldOutPictures(seed, 4, 40);
  pictures.targets = {kind};
  return pictures;
}

PictureConfig TuningPicturesOf(TargetKind kind, std::uint64_t seed) {
  PictureConfig pictures = TrialPicturesOf(kind, seed);
  pictures.split = Split::kTrain;
  pictures.pairs = 4;
  return pictures;
}

void WriteLabelledFolder(const Scenario& base, const PictureConfig& pictures, int n_pairs,
                         const fs::path& folder) {
  for (const char* part : {"images", "labels"}) fs::create_directories(folder / part);
  std::size_t n_written = 0;
  cv::Size size;
  const auto write = [&](const cv::Mat& left, const cv::Mat& right) -> FoundInPair {
    const cv::Mat* rgb[] = {&left, &right};
    size = left.size();
    for (std::size_t eye = 0; eye < 2; ++eye) {
      cv::Mat bgr;
      cv::cvtColor(*rgb[eye], bgr, cv::COLOR_RGB2BGR);
      WriteImageFile(bgr, folder / "images" / (NameOf(n_written, eye) + ".png"));
    }
    ++n_written;
    return {};
  };
  // In order: one thread draws.
  const auto results =
      ShowPictures(base, pictures, n_pairs, /*threads=*/1, write, [](int) { return true; });
  for (std::size_t pair = 0; pair < results.size(); ++pair) {
    for (std::size_t eye = 0; eye < 2; ++eye) {
      ReplaceFile(folder / "labels" / (NameOf(pair, eye) + ".txt"),
                  LabelsText(results[pair].eyes[eye].labels, size));
    }
  }
}

std::vector<std::vector<TriedFrame>> RangesOn(const std::vector<TriedPair>& pairs,
                                              int pairs_a_scene, BoxSource source,
                                              const Scenario& base,
                                              const std::vector<TrialMethod>& methods) {
  const auto estimators = EstimatorsOf(base, methods);
  std::vector<std::vector<TriedFrame>> scenes;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (i % static_cast<std::size_t>(pairs_a_scene) == 0) scenes.emplace_back();
    if (!HasClearTarget(pairs[i])) continue;
    TriedFrame& frame = scenes.back().emplace_back();
    frame.reference_m = pairs[i].result.eyes[0].labels.front().range_m;
    const std::optional<stereo_box_t> box = BoxOf(pairs[i], source);
    for (const auto& estimator : estimators) {
      std::optional<RangeSolution> solution;
      if (box) solution = estimator->Estimate({.box = *box});
      frame.range_m.push_back(solution ? std::optional(solution->range_m) : std::nullopt);
    }
  }
  return scenes;
}

}  // namespace windhover
