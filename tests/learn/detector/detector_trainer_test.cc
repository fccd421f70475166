#include "learn/detector/detector_trainer.h"

#include <cmath>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>

#include "common/random/random_stream.h"
#include "learn/detector/labelled_folder.h"
#include "learn/detector/torch_network.h"
#include "network/box_decoding.h"
#include "network/detector_input.h"
#include "network/network_onnx.h"

namespace windhover {
namespace {

constexpr int kSide_px = 64;
constexpr int kBatch = 32;  // Below 16 a thread libtorch takes a slower way.

/// What is to be found: a dark cross with a light hub (a quadrotor from above, to a child), or a
/// light ring, before noise.
enum class Look { kCross, kRing };

/// A picture of `size` with one of them, or none.
DetectorSample Picture(RandomStream* random, bool empty, Look look = Look::kCross,
                       cv::Size size = {kSide_px, kSide_px}) {
  DetectorSample sample{.rgb = cv::Mat(size, CV_8UC3), .box = {}};
  for (auto it = sample.rgb.begin<cv::Vec3b>(); it != sample.rgb.end<cv::Vec3b>(); ++it) {
    for (int c = 0; c < 3; ++c) {
      (*it)[c] = cv::saturate_cast<uchar>(140 + 20 * random->Normal());
    }
  }
  if (empty) return sample;
  const int half = static_cast<int>(random->Uniform(5, 14));
  const auto x = static_cast<int>(random->Uniform(half, size.width - half));
  const auto y = static_cast<int>(random->Uniform(half, size.height - half));
  const cv::Point centre(x, y), a(half, half), b(half, -half);
  if (look == Look::kCross) {
    cv::line(sample.rgb, centre - a, centre + a, cv::Scalar(30, 30, 40), 2);
    cv::line(sample.rgb, centre - b, centre + b, cv::Scalar(30, 30, 40), 2);
    cv::circle(sample.rgb, centre, half / 3, cv::Scalar(230, 120, 40), cv::FILLED);
  } else {
    cv::circle(sample.rgb, centre, half - 1, cv::Scalar(250, 250, 250), 3);
  }
  sample.box = image_box_t{double(x), double(y), 2.0 * half + 1, 2.0 * half + 1};
  return sample;
}

// Every eighth picture is empty.
std::vector<DetectorSample> PictureBatch(int step, const char* name = "train",
                                         Look look = Look::kCross) {
  std::vector<DetectorSample> batch;
  for (int i = 0; i < kBatch; ++i) {
    RandomStream random(static_cast<std::uint64_t>(step * kBatch + i), name);
    batch.push_back(Picture(&random, i % 8 == 0, look));
  }
  return batch;
}

/// Shares of the pictures with a target whose best box overlaps it by half.
double HitShare(const DetectorTrainer& trainer, const NetworkWeights& weights,
                Look look = Look::kCross) {
  const YoloxNetwork plain = WithoutNorm(trainer.network());
  TorchNetwork torch(plain);
  LearnedNetwork folded;
  for (const ConvWeights& own : weights.layers) {
    auto& p = folded.parameters;
    p.insert(p.end(), own.weight.begin(), own.weight.end());
    p.insert(p.end(), own.bias.begin(), own.bias.end());
  }
  int hits = 0, targets = 0;
  const std::vector<DetectorSample> batch = PictureBatch(0, "held out", look);
  const auto outputs = torch.Outputs(batch, folded);
  for (std::size_t image = 0; image < batch.size(); ++image) {
    double best = -1e9, overlap = 0;
    for (std::size_t l = 0; batch[image].box && l < outputs.size(); ++l) {
      const int columns = kSide_px / plain.strides[l];
      const auto area = static_cast<std::size_t>(columns * columns);
      for (std::size_t i = 0; i < area; ++i) {
        const auto at = [&](std::size_t n) {
          return double{outputs[l][(image * 6 + n) * area + i]};
        };
        const CellPrediction cell = {plain.strides[l],
                                     static_cast<int>(i) / columns,
                                     static_cast<int>(i) % columns,
                                     at(0),
                                     at(1),
                                     at(2),
                                     at(3),
                                     at(4),
                                     at(5)};
        const double score = -std::log1p(std::exp(-cell.obj)) - std::log1p(std::exp(-cell.cls));
        if (score <= best) continue;
        best = score;
        overlap = OverlapOf(cell.Box(), *batch[image].box);
      }
    }
    targets += batch[image].box ? 1 : 0;
    hits += overlap > 0.5 ? 1 : 0;
  }
  return static_cast<double>(hits) / targets;
}

std::vector<float> Numbers(const NetworkWeights& weights) {
  std::vector<float> all;
  for (const ConvWeights& own : weights.layers) {
    all.insert(all.end(), own.weight.begin(), own.weight.end());
    all.insert(all.end(), own.bias.begin(), own.bias.end());
  }
  return all;
}

// --- libtorch against the table, by way of the written file and OpenCV. --------------------------

TEST(TorchNetwork, GivesWhatTheWrittenNetworkGives) {
  const YoloxNetwork network = MakeYolox("yolox_nano");
  LearnedNetwork learned = InitialNetwork(network.table, 1);
  RandomStream random(1, "test/statistics");
  for (float& value : learned.statistics) value = static_cast<float>(random.Uniform(0.2, 0.9));
  const std::vector<DetectorSample> batch = {Picture(&random, false)};
  const auto outputs = TorchNetwork(network).Outputs(batch, learned);
  const std::string model =
      NetworkOnnx(network.table, Folded(network.table, learned), kSide_px, kSide_px);
  cv::dnn::Net net = cv::dnn::readNetFromONNX(model.data(), model.size());
  cv::Mat image(std::vector<int>{1, 3, kSide_px, kSide_px}, CV_32F);
  ToPlanes(batch[0].rgb, {image.ptr<float>(), image.total()});
  net.setInput(image);
  for (std::size_t l = 0; l < outputs.size(); ++l) {
    const cv::Mat expected = net.forward("head" + std::to_string(l));
    ASSERT_EQ(expected.total(), outputs[l].size());
    const double largest = cv::norm(expected, cv::NORM_INF);
    for (std::size_t i = 0; i < outputs[l].size(); ++i) {
      // float's 6e-8 of each of some hundred sums on the way.
      ASSERT_NEAR(outputs[l][i], expected.ptr<float>()[i], 1e-5 * largest);
    }
  }
}

// --- Numeric derivative. -------------------------------------------------------------------------

// Along the gradient g the loss rises by |g|². Without targets the loss is smooth: none is
// assigned.
TEST(TorchNetwork, GradientIsTheDerivative) {
  const YoloxNetwork network = MakeYolox("yolox_nano");
  const LearnedNetwork start = InitialNetwork(network.table, 1);
  RandomStream random(2, "test/empty");
  std::vector<DetectorSample> batch;
  for (int i = 0; i < 16; ++i) batch.push_back(Picture(&random, false));
  for (DetectorSample& sample : batch) sample.box.reset();
  TorchNetwork torch(network);
  std::vector<float> gradient, ignored;
  LearnedNetwork here = start;
  torch.Gradient(batch, &here, &gradient);
  double squares = 0;
  for (const float g : gradient) squares += static_cast<double>(g) * g;
  const auto loss_at = [&](double offset) {
    LearnedNetwork moved = start;
    const auto step = static_cast<float>(offset / std::sqrt(squares));
    for (std::size_t i = 0; i < gradient.size(); ++i) moved.parameters[i] += step * gradient[i];
    return torch.Gradient(batch, &moved, &ignored).Total();
  };
  const double slope = (loss_at(3e-4) - loss_at(-3e-4)) / 6e-4;
  // float's rounding of a loss of 14 gives 3e-4; the curvature is less.
  EXPECT_NEAR(slope / std::sqrt(squares), 1, 1e-3);
}

// --- The trainer. --------------------------------------------------------------------------------

DetectorRecipe TinyRecipe(int steps) {
  DetectorRecipe recipe;
  recipe.steps = steps;
  recipe.rate = 4e-3;
  return recipe;
}

TEST(DetectorTrainer, GoesOnToTheSameBitsOnAnyNumberOfThreads) {
  DetectorTrainer whole(TinyRecipe(4), 1), first(TinyRecipe(4), 2), second(TinyRecipe(4), 2);
  for (int step = 0; step < 4; ++step) ASSERT_TRUE(whole.Step(PictureBatch(step)));
  for (int step = 0; step < 2; ++step) ASSERT_TRUE(first.Step(PictureBatch(step)));
  second.Restore(nlohmann::json::from_cbor(nlohmann::json::to_cbor(first.State())));
  EXPECT_EQ(second.steps_done(), 2);
  for (int step = 2; step < 4; ++step) ASSERT_TRUE(second.Step(PictureBatch(step)));
  EXPECT_EQ(Numbers(second.Average()), Numbers(whole.Average()));
  EXPECT_NE(Numbers(first.Average()), Numbers(whole.Average()));
}

TEST(DetectorTrainer, RefusesTheStateOfAnotherNetwork) {
  DetectorRecipe other = TinyRecipe(4);
  other.network = "yolox_nano";
  DetectorTrainer small(TinyRecipe(4), 1), nano(other, 1);
  EXPECT_THROW(small.Restore(nano.State()), std::exception);
  nlohmann::json cut = small.State();
  cut.erase("statistics");
  EXPECT_THROW(small.Restore(cut), std::exception);
}

/// A dozen labelled pictures of rings, as large as the first network sees them.
std::vector<LabelledFile> Rings() {
  std::vector<LabelledFile> files;
  for (std::uint64_t i = 0; i < 12; ++i) {
    RandomStream random(i, "rings");
    const DetectorSample picture = Picture(&random, false, Look::kRing, {352, 192});
    files.push_back({.file = {}, .rgb = picture.rgb, .boxes = {*picture.box}});
  }
  return files;
}

class Crosses final : public DetectorSampleSource {
 public:
  std::vector<DetectorSample> Batch(int step) override { return PictureBatch(300 + step); }
};

// It learns from pictures, and, without batch normalisation, goes on from what it has learned: a
// dozen pictures of what it never saw, beside those of what it knows, mend it, and it forgets
// nothing.
TEST(DetectorTrainer, LearnsToFindAndIsFineTuned) {
  constexpr int kSteps = 120, kTuningSteps = 40;
  DetectorTrainer trainer(TinyRecipe(kSteps), 1);
  EXPECT_LT(HitShare(trainer, trainer.Average()), 0.3);
  for (int step = 0; step < kSteps; ++step) ASSERT_TRUE(trainer.Step(PictureBatch(step)));
  EXPECT_GT(HitShare(trainer, trainer.Average()), 0.7);
  EXPECT_LT(HitShare(trainer, trainer.Average(), Look::kRing), 0.3);
  DetectorRecipe fine = TinyRecipe(kTuningSteps);
  fine.rate = 1e-3;
  DetectorTrainer tuned(fine, 1, trainer.Average());
  EXPECT_EQ(Numbers(tuned.Average()), Numbers(trainer.Average()));
  const ReplayConfig crops{.batch = kBatch, .size = {kSide_px, kSide_px}, .whole_every = 0};
  const auto source =
      Mixed(MakeFolderSource(Rings(), false, crops), std::make_unique<Crosses>(), 0.5);
  for (int step = 0; step < kTuningSteps; ++step) ASSERT_TRUE(tuned.Step(source->Batch(step)));
  EXPECT_GT(HitShare(trainer, tuned.Average(), Look::kRing), 0.5);
  EXPECT_GT(HitShare(trainer, tuned.Average()), 0.7);
}

// With one batch again and again s(k) - s(∞) is 0.97^k of what it was: from 20 to 40 statistics
// move 0.97^20 of what they did from 0 to 20, to rounding. Weights stay.
TEST(DetectorTrainer, StatisticsSettleOnABatch) {
  DetectorTrainer trainer({.network = "yolox_small", .steps = 1}, 2);
  const auto statistics_after = [&](int n) {
    for (int i = 0; i < n; ++i) trainer.Settle(PictureBatch(7));
    const nlohmann::json state = trainer.State();
    const auto& bytes = state.at("average_statistics").get_binary();
    std::vector<float> values(bytes.size() / sizeof(float));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  };
  const nlohmann::json before = trainer.State();
  const auto first = statistics_after(0), second = statistics_after(20),
             third = statistics_after(20);
  double moved = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const double by = second[i] - first[i];
    moved = std::max(moved, std::abs(by));
    EXPECT_NEAR(third[i] - second[i], std::pow(0.97, 20) * by, 1e-4 + 1e-3 * std::abs(by));
  }
  EXPECT_GT(moved, 0.1);
  EXPECT_EQ(trainer.State().at("average_parameters"), before.at("average_parameters"));
}

}  // namespace
}  // namespace windhover
