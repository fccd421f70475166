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

image_box_t Difference(const image_box_t& found, const image_box_t& label) {
  image_box_t error{};
  error.x_px = found.x_px - label.x_px;
  error.y_px = found.y_px - label.y_px;
  error.w_px = found.w_px - label.w_px;
  error.h_px = found.h_px - label.h_px;
  return error;
}

std::vector<ScoredBox> AtLeast(double min_score, std::vector<ScoredBox> found) {
  std::erase_if(found, [&](const ScoredBox& one) { return one.score < min_score; });
  return BestFirst(std::move(found));
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

std::vector<std::optional<ScoredBox>> Matches(const ImageResult& image, double min_score) {
  const std::vector<ScoredBox> found = AtLeast(min_score, image.found);
  const std::vector<int> taken = TakenBy(found, image.labels, 0.5);
  std::vector<std::optional<ScoredBox>> matches(image.labels.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (taken[i] != kNone) matches[static_cast<std::size_t>(taken[i])] = found[i];
  }
  return matches;
}

std::vector<RecallBin> RecallByDistance(const std::vector<ImageResult>& images,
                                        const std::vector<double>& edges_m, double min_score) {
  std::vector<RecallBin> bins;
  for (std::size_t i = 1; i < edges_m.size(); ++i) bins.push_back({edges_m[i - 1], edges_m[i]});
  for (const ImageResult& image : images) {
    const auto matches = Matches(image, min_score);
    for (std::size_t i = 0; i < matches.size(); ++i) {
      const LabelledBox& label = image.labels[i];
      for (RecallBin& bin : bins) {
        if (!label.counts || label.range_m < bin.nearest_m || label.range_m >= bin.farthest_m) {
          continue;
        }
        ++bin.n;
        bin.n_found += matches[i].has_value();
      }
    }
  }
  return bins;
}

int CountFalseDetections(const std::vector<ImageResult>& images, double min_score) {
  int n = 0;
  for (const ImageResult& image : images) {
    const std::vector<int> taken = TakenBy(AtLeast(min_score, image.found), image.labels, 0.5);
    n += static_cast<int>(std::count(taken.begin(), taken.end(), kNone));
  }
  return n;
}

std::vector<StereoBoxError> StereoBoxErrors(const ImageResult& left, const ImageResult& right,
                                            double min_score) {
  const auto in_left = Matches(left, min_score), in_right = Matches(right, min_score);
  std::vector<StereoBoxError> errors;
  for (std::size_t i = 0; i < std::min(in_left.size(), in_right.size()); ++i) {
    const LabelledBox &a = left.labels[i], &b = right.labels[i];
    if (!in_left[i] || !in_right[i] || !a.counts || !b.counts) continue;
    errors.push_back({.left = Difference(in_left[i]->box, a.box),
                      .right = Difference(in_right[i]->box, b.box),
                      .width_px = (a.box.w_px + b.box.w_px) / 2,
                      .range_m = a.range_m});
  }
  return errors;
}

}  // namespace windhover
