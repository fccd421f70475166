#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <future>
#include <limits>
#include <optional>
#include <vector>

#include "common/random/random_stream.h"
#include "learn/detector/detector_sample.h"

namespace windhover {

/// How batches are drawn from scenes.
struct ReplayConfig {
  std::uint64_t seed = 1;
  int batch = 32;
  cv::Size size = {128, 128};  ///< Of a sample; pictures of a scene are that large at least.
  double positive_share = 0.7;
  /// Every so many steps pictures are whole, as the nearest targets do not fit a crop; 0: never.
  int whole_every = 5;
  int whole_batch = 16;
  /// From this step on all are whole.
  int whole_from = std::numeric_limits<int>::max();
  int first_scenes = 6;      ///< That are there at step 0.
  int steps_per_scene = 24;  ///< A new scene every so many steps.
  int scenes_kept = 40;      ///< The newest.
};

/// Draws batches from the newest scenes of an endless row, so that each picture is seen several
/// times, in other crops and colours, while new ones come in. The next scene is made beside the
/// training, on a thread of its own.
///
/// A batch is a function of the step: which scenes are there is, and what is drawn from them. A
/// source that begins at a later step makes the scenes kept then first.
class ReplaySource final : public DetectorSampleSource {
 public:
  /// Makes the samples of a scene, at least one, a function of its number; called by one thread at
  /// a time.
  using MakeScene = std::function<std::vector<DetectorSample>(int scene)>;

  ReplaySource(MakeScene make, const ReplayConfig& config);
  ~ReplaySource() override;

  /// Where there is no sample with an aircraft, or none without, the other kind stands in.
  /// @throws what making a scene throws; std::runtime_error if nothing can be drawn.
  std::vector<DetectorSample> Batch(int step) override;

  /// Number after the newest scene that is there at `step`.
  int ScenesUntil(int step) const { return config_.first_scenes + step / config_.steps_per_scene; }

 private:
  void Keep(int first, int end);
  std::optional<DetectorSample> DrawSample(bool is_whole, bool shows_box,
                                           RandomStream* random) const;
  std::vector<DetectorSample> TakeScene(int scene);

  MakeScene make_;
  ReplayConfig config_;
  int first_ = 0;                                 ///< Number of the oldest scene kept.
  std::deque<std::vector<DetectorSample>> kept_;  ///< From `first_` on.
  int coming_ = -1;                               ///< Number of the scene in `next_`.
  std::future<std::vector<DetectorSample>> next_;
};

}  // namespace windhover
