#include "learn/detector/average_precision.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace windhover {
namespace {

constexpr std::size_t kMostDetections = 100;
constexpr int kNone = -1;

std::vector<ScoredBox> BestFirst(std::vector<ScoredBox> found) {
  std::stable_sort(found.begin(), found.end(),
                   [](const ScoredBox& a, const ScoredBox& b) { return a.score > b.score; });
  if (found.size() > kMostDetections) found.resize(kMostDetections);
  return found;
}

bool IsWithin(const WidthRange& widths, const image_box_t& box) {
  return box.w_px >= widths.least_px && box.w_px < widths.below_px;
}

// For each detection, best first, the label it takes. A label that counts is preferred to one that
// does not, however much more that overlaps.
std::vector<int> TakenBy(const std::vector<ScoredBox>& found,
                         const std::vector<LabelledBox>& labels, double overlap) {
  std::vector<bool> is_taken(labels.size());
  std::vector<int> taken;
  for (const ScoredBox& detection : found) {
    int best = kNone;
    double best_overlap = overlap;
    for (const bool counts : {true, false}) {
      if (best != kNone) break;
      for (std::size_t i = 0; i < labels.size(); ++i) {
        if (is_taken[i] || labels[i].counts != counts) continue;
        const double shared = OverlapOf(detection.box, labels[i].box);
        if (shared < best_overlap) continue;
        best = static_cast<int>(i);
        best_overlap = shared;
      }
    }
    if (best != kNone) is_taken[static_cast<std::size_t>(best)] = true;
    taken.push_back(best);
  }
  return taken;
}

/// One detection that is right or wrong.
struct Verdict {
  double score;
  bool is_right;
};

// Of one image; adds its labels that count to `*n_labels`.
std::vector<Verdict> Judge(const ImageResult& image, double overlap, const WidthRange& widths,
                           int* n_labels) {
  std::vector<LabelledBox> labels = image.labels;
  for (LabelledBox& label : labels) {
    label.counts = label.counts && IsWithin(widths, label.box);
    *n_labels += label.counts;
  }
  const std::vector<ScoredBox> found = BestFirst(image.found);
  const std::vector<int> taken = TakenBy(found, labels, overlap);
  std::vector<Verdict> verdicts;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool took_one = taken[i] != kNone;
    const bool counts = took_one ? labels[static_cast<std::size_t>(taken[i])].counts
                                 : IsWithin(widths, found[i].box);
    if (counts) verdicts.push_back({found[i].score, took_one});
  }
  return verdicts;
}

// Of verdicts in order of their scores.
double MeanPrecision(const std::vector<Verdict>& verdicts, int n_labels) {
  std::vector<double> recall, precision;
  int n_right = 0;
  for (const Verdict& verdict : verdicts) {
    n_right += verdict.is_right;
    recall.push_back(1.0 * n_right / n_labels);
    precision.push_back(n_right / (1.0 + static_cast<double>(precision.size())));
  }
  for (std::size_t i = precision.size(); i-- > 1;) {
    precision[i - 1] = std::max(precision[i - 1], precision[i]);
  }
  double sum = 0;
  for (int i = 0; i <= 100; ++i) {
    const auto reached = std::lower_bound(recall.begin(), recall.end(), i / 100.0);
    if (reached == recall.end()) break;
    sum += precision[static_cast<std::size_t>(reached - recall.begin())];
  }
  return sum / 101;
}

}  // namespace

std::optional<double> AveragePrecision(const std::vector<ImageResult>& images, double overlap,
                                       const WidthRange& widths) {
  std::vector<Verdict> verdicts;
  int n_labels = 0;
  for (const ImageResult& image : images) {
    const std::vector<Verdict> judged = Judge(image, overlap, widths, &n_labels);
    verdicts.insert(verdicts.end(), judged.begin(), judged.end());
  }
  if (n_labels == 0) return std::nullopt;
  std::stable_sort(verdicts.begin(), verdicts.end(),
                   [](const Verdict& a, const Verdict& b) { return a.score > b.score; });
  return MeanPrecision(verdicts, n_labels);
}

std::optional<double> MeanAveragePrecision(const std::vector<ImageResult>& images,
                                           const WidthRange& widths) {
  double sum = 0;
  for (int percent = 50; percent < 100; percent += 5) {
    const auto precision = AveragePrecision(images, percent / 100.0, widths);
    if (!precision) return std::nullopt;
    sum += *precision;
  }
  return sum / 10;
}

}  // namespace windhover
