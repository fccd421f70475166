#pragma once

#include <memory>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "network/box_decoding.h"
#include "network/detector_input.h"
#include "network/inference.h"
#include "network/network_file.h"

namespace windhover {

/// Who runs a network; both give the same boxes, to 1e-4.
enum class EngineKind { kOneDnn, kOpenCv };

inline constexpr double kMaxOverlap = 0.5;       ///< Of two targets: more is one seen twice.
inline constexpr std::size_t kMaxTargets = 8;    ///< Of an image.
inline constexpr double kWorthALook = 0.05;      ///< Score from which a second network looks again.
inline constexpr double kMinOverlapAgain = 0.2;  ///< Of its box, or it sees another target.

/// A network that finds boxes in parts of images.
class BoxNetwork {
 public:
  /// Prepares the network for `batch` views at once.
  /// @throws std::runtime_error if the engine cannot be made.
  BoxNetwork(NetworkModel model, int batch, EngineKind kind = EngineKind::kOneDnn);

  /// px
  cv::Size input() const { return {model_.width, model_.height}; }

  struct View {
    const cv::Mat& rgb;
    InputWindow window;
  };

  /// Boxes that score at least `min_score` in each of as many views as the batch has, in px of the
  /// images: all of them, in the order of the network's cells.
  /// @throws std::invalid_argument if an image is not 8-bit RGB, std::runtime_error if the network
  /// gives numbers that are not finite.
  std::vector<std::vector<ScoredBox>> Find(std::span<const View> views, double min_score);

  /// Targets in whole images, as many as the batch has: best first, kMaxTargets of each at most,
  /// none that overlaps a better one by more than kMaxOverlap. @throws as Find().
  std::vector<std::vector<ScoredBox>> FindInWhole(std::span<const cv::Mat> images,
                                                  double min_score);

 private:
  NetworkModel model_;
  std::vector<LayerShape> shapes_;
  std::size_t batch_;
  std::unique_ptr<InferenceEngine> engine_;
  std::vector<float> images_;
};

}  // namespace windhover
