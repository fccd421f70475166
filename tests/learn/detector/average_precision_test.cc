#include "learn/detector/average_precision.h"

#include <algorithm>
#include <tuple>

#include <gtest/gtest.h>

#include "common/random/random_stream.h"
#include "learn/detector/evaluation_set.h"
#include "tests/support/image_box.h"

namespace windhover {
namespace {

ScoredBox Found(double score, double x_px, double w_px = 10) {
  return {.box = Box(x_px, 0, w_px, 10), .score = score};
}

LabelledBox Label(double x_px, double range_m = 10, double w_px = 10) {
  return {.box = Box(x_px, 0, w_px, 10), .range_m = range_m};
}

// Two aircraft in two images. Best first: right, wrong, right. Recall 1/2 at precision 1, recall 1
// at 2/3: 51 recalls (0 to 0.50) have 1, the other 50 have 2/3.
TEST(AveragePrecision, OfThreeDetections) {
  const std::vector<ImageResult> images = {
      {.labels = {Label(0)}, .found = {Found(0.9, 0), Found(0.7, 40)}},
      {.labels = {Label(100)}, .found = {Found(0.5, 101)}}};
  EXPECT_NEAR(*AveragePrecision(images, 0.5), (51 + 50 * 2.0 / 3) / 101, 1e-12);
}

// The second detection overlaps 9 of 11 px: right up to 0.8, that is at 7 of 10 overlaps.
TEST(AveragePrecision, IsAveragedOverOverlaps) {
  const std::vector<ImageResult> images = {{.labels = {Label(100)}, .found = {Found(0.5, 101)}}};
  EXPECT_NEAR(*MeanAveragePrecision(images), 0.7, 1e-12);
}

TEST(AveragePrecision, CountsADoubleAsWrong) {
  const std::vector<ImageResult> images = {
      {.labels = {Label(0)}, .found = {Found(0.4, 0), Found(0.9, 1)}}};
  EXPECT_NEAR(*AveragePrecision(images, 0.5), 1, 1e-12);  // The double comes after all is found.
}

TEST(AveragePrecision, LeavesOutWhatDoesNotCount) {
  LabelledBox hidden = Label(50);
  hidden.counts = false;
  const std::vector<ImageResult> images = {
      {.labels = {Label(0), hidden}, .found = {Found(0.9, 50), Found(0.8, 0)}}};
  EXPECT_NEAR(*AveragePrecision(images, 0.5), 1, 1e-12);
  EXPECT_FALSE(AveragePrecision({{.labels = {hidden}, .found = {Found(0.9, 50)}}}, 0.5));
}

// A wrong detection counts where its own width does.
TEST(AveragePrecision, OfARangeOfWidths) {
  const std::vector<ImageResult> images = {
      {.labels = {Label(0, 10, 10), Label(100, 5, 30)},
       .found = {Found(0.9, 300, 30), Found(0.8, 0, 10), Found(0.7, 100, 30)}}};
  EXPECT_NEAR(*AveragePrecision(images, 0.5, {.least_px = 0, .below_px = 20}), 1, 1e-12);
  EXPECT_NEAR(*AveragePrecision(images, 0.5, {.least_px = 20}), 0.5, 1e-12);
}

/// The definition, written down without shortcuts: for each recall the best precision of all
/// lists of detections above some score that reach it, each list matched anew.
class Definition {
 public:
  Definition(const std::vector<ImageResult>& images, double overlap)
      : images_(images), overlap_(overlap) {
    for (const ImageResult& image : images) {
      for (const ScoredBox& one : image.found) scores_.push_back(one.score);
      for (const LabelledBox& label : image.labels) n_labels_ += label.counts;
    }
  }

  double AveragePrecision() const {
    double sum = 0;
    for (int i = 0; i <= 100; ++i) {
      double best = 0;
      for (const double least : scores_) {
        const auto [n_right, n_wrong] = CountAbove(least);
        if (1.0 * n_right / n_labels_ < i / 100.0 || n_right + n_wrong == 0) continue;
        best = std::max(best, 1.0 * n_right / (n_right + n_wrong));
      }
      sum += best / 101;
    }
    return sum;
  }

 private:
  static double Shared(const image_box_t& a, const image_box_t& b) {
    const auto common = [](double p, double p_size, double q, double q_size) {
      return std::max(
          0.0, std::min(p + p_size / 2, q + q_size / 2) - std::max(p - p_size / 2, q - q_size / 2));
    };
    const double both =
        common(a.x_px, a.w_px, b.x_px, b.w_px) * common(a.y_px, a.h_px, b.y_px, b.h_px);
    return both / (a.w_px * a.h_px + b.w_px * b.h_px - both);
  }

  std::pair<int, int> CountAbove(double least) const {
    int n_right = 0, n_wrong = 0;
    for (const ImageResult& image : images_) {
      std::vector<ScoredBox> list;
      for (const ScoredBox& one : image.found) {
        if (one.score >= least) list.push_back(one);
      }
      std::sort(list.begin(), list.end(), [](auto& a, auto& b) { return a.score > b.score; });
      std::vector<LabelledBox> left = image.labels;
      for (const ScoredBox& one : list) {
        const auto best = std::max_element(left.begin(), left.end(), [&](auto& a, auto& b) {
          return Rank(one, a) < Rank(one, b);
        });
        if (best == left.end() || Shared(one.box, best->box) < overlap_) {
          ++n_wrong;
          continue;
        }
        n_right += best->counts;
        left.erase(best);
      }
    }
    return {n_right, n_wrong};
  }

  // Labels that it can take are better than others, those that count better than the rest.
  std::tuple<bool, bool, double> Rank(const ScoredBox& one, const LabelledBox& label) const {
    const double shared = Shared(one.box, label.box);
    return {shared >= overlap_, label.counts, shared};
  }

  const std::vector<ImageResult>& images_;
  double overlap_;
  std::vector<double> scores_;
  int n_labels_ = 0;
};

TEST(AveragePrecision, IsItsDefinition) {
  RandomStream random(4, "average precision");
  int n_between = 0;
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<ImageResult> images(6);
    for (ImageResult& image : images) {
      const int n = static_cast<int>(random.Uniform(0, 4));
      for (int i = 0; i < n; ++i) {
        image.labels.push_back({.box = Box(random.Uniform(0, 60), random.Uniform(0, 20), 14, 9),
                                .counts = random.Uniform() < 0.8});
        for (int k = 0; k < 2; ++k) {
          const image_box_t& label = image.labels.back().box;
          image.found.push_back(
              {.box = Box(label.x_px + 3 * random.Normal(), label.y_px + random.Normal(), 14, 10),
               .score = random.Uniform()});
        }
      }
    }
    images[0].labels.push_back({.box = Box(0, 0, 14, 9)});
    for (const double overlap : {0.5, 0.75}) {
      const double precision = *AveragePrecision(images, overlap);
      EXPECT_NEAR(precision, Definition(images, overlap).AveragePrecision(), 1e-9);
      n_between += precision > 0.1 && precision < 0.9;
    }
  }
  EXPECT_GT(n_between, 40);
}

Scenario SmallRig() {
  Scenario scenario;
  scenario.description = "test";
  scenario.rig.calibrated.image = {320, 180};
  scenario.rig.calibrated.pixel_um = 4 * 3.7325;
  scenario.aircraft.resize(1);
  return scenario;
}

/// Finds the brightness of the first pixel, so that what was seen is known.
FoundInPair FirstPixels(const cv::Mat& left, const cv::Mat& right) {
  return {{{Found(left.at<cv::Vec3b>(0, 0)[0] / 255.0, 1)},
           {Found(right.at<cv::Vec3b>(0, 0)[0] / 255.0, 2)}}};
}

TEST(EvaluationSet, IsTheSameOnTwoThreads) {
  PictureConfig pictures = HeldOutPictures(5, 4, 40);
  pictures.pairs = 2;
  std::vector<std::vector<PairResult>> runs;
  for (const int threads : {1, 2}) {
    runs.push_back(
        ShowPictures(SmallRig(), pictures, 5, threads, FirstPixels, [](int) { return true; }));
  }
  int n_labels = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t eye = 0; eye < 2; ++eye) {
      const ImageResult &one = runs[0][i].eyes[eye], &two = runs[1][i].eyes[eye];
      ASSERT_EQ(one.found.size(), 1u);
      EXPECT_EQ(one.found[0].score, two.found[0].score);
      ASSERT_EQ(one.labels.size(), two.labels.size());
      n_labels += static_cast<int>(one.labels.size());
      if (one.labels.empty()) continue;
      EXPECT_EQ(one.labels[0].box.x_px, two.labels[0].box.x_px);
      EXPECT_GT(one.labels[0].range_m, 3.9);
      EXPECT_LT(one.labels[0].range_m, 41);  // Depth of 40 m at most, and off the axis.
    }
  }
  EXPECT_EQ(n_labels, 10);  // Whole in both images.
}

TEST(EvaluationSet, HasEmptyPictures) {
  PictureConfig pictures = EmptyPictures(5, 0);
  pictures.pairs = 3;
  const auto results =
      ShowPictures(SmallRig(), pictures, 3, 1, FirstPixels, [](int) { return true; });
  for (const PairResult& pair : results) {
    for (const ImageResult& image : pair.eyes) {
      EXPECT_TRUE(image.labels.empty());
      EXPECT_EQ(image.found.size(), 1u);
    }
  }
}

}  // namespace
}  // namespace windhover
