#include "learn/detector/evaluation_set.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <utility>

#include "learn/detector/picture_samples.h"
#include "render/parallel_for.h"

namespace windhover {
namespace {

ImageResult LabelsOf(const LabelledPair& pair, const LabelledPicture& picture) {
  ImageResult result;
  if (!picture.box) return result;
  result.labels.push_back(
      {.box = *picture.box, .range_m = pair.range_m, .counts = IsClear(picture)});
  return result;
}

}  // namespace

PictureConfig HeldOutPictures(std::uint64_t seed, double nearest_m, double farthest_m) {
  PictureConfig config;
  config.seed = seed;
  config.split = Split::kTest;
  config.targets = {TargetKind::kM200Orange, TargetKind::kM200Black, TargetKind::kP600};
  config.nearest_m = nearest_m;
  config.farthest_m = farthest_m;
  config.empty_share = 0;
  config.most_distractors = 0;
  config.pairs = 10;
  config.is_randomised = false;
  return config;
}

PictureConfig EmptyPictures(std::uint64_t seed, int most_distractors) {
  PictureConfig config = HeldOutPictures(seed, 4, 40);
  config.empty_share = 1;
  config.most_distractors = most_distractors;
  return config;
}

std::vector<PairResult> ShowPictures(
    const Scenario& base, const PictureConfig& pictures, int n_pairs, int threads,
    const std::function<FoundInPair(const cv::Mat& left, const cv::Mat& right)>& detect,
    const std::function<bool(int done)>& on_progress) {
  Scenario full = base;
  full.sensor.model = SensorModel::kEmva1288;
  std::vector<PairResult> results(static_cast<std::size_t>(n_pairs));
  const int n_scenes = (n_pairs + pictures.pairs - 1) / pictures.pairs;
  std::mutex mutex;
  std::atomic<bool> goes_on = true;
  int done = 0;
  ParallelFor(n_scenes, threads, [&](int number, int) {
    if (!goes_on) return;
    PictureScene scene(full, pictures, number);
    const int first = number * pictures.pairs;
    for (int i = 0; i < scene.size() && first + i < n_pairs && goes_on; ++i) {
      const LabelledPair pair = scene.Draw(i);
      PairResult result{{LabelsOf(pair, pair.eyes[0]), LabelsOf(pair, pair.eyes[1])}, pair.kind};
      const std::scoped_lock lock(mutex);
      FoundInPair found = detect(pair.eyes[0].rgb, pair.eyes[1].rgb);
      for (std::size_t eye = 0; eye < 2; ++eye) result.eyes[eye].found = std::move(found[eye]);
      results[static_cast<std::size_t>(first + i)] = std::move(result);
      if (!on_progress(++done)) goes_on = false;
    }
  });
  return results;
}

}  // namespace windhover
