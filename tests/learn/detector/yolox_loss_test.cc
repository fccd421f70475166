#include "learn/detector/yolox_loss.h"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/random/random_stream.h"
#include "learn/detector/learned_network.h"
#include "network/yolox.h"

namespace windhover {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// A cell of stride 8 that predicts a box of that size in its own middle.
CellPrediction Cell(int row, int column, double side_px, double obj = 0) {
  return {8, row, column, 0.5, 0.5, std::log(side_px / 8), std::log(side_px / 8), obj, 0};
}

// --- Worked examples. ----------------------------------------------------------------------------

TEST(YoloxLoss, ReadsABoxOffTheRawNumbers) {
  // 2.5 cells of 8 px right of the edge, which is half a pixel left of the first pixel's centre.
  const image_box_t box = Cell(1, 2, 16).Box();
  EXPECT_NEAR(box.x_px, 2.5 * 8 - 0.5, 1e-12);
  EXPECT_NEAR(box.y_px, 1.5 * 8 - 0.5, 1e-12);
  EXPECT_NEAR(box.w_px, 16, 1e-12);
}

// A row of cells, the target on that of column 5: the best ten overlaps are 1, two of 8/24 (boxes
// of 16 px, 8 px apart), and zeros, so k = 1; the right box wins, whatever the others' scores.
TEST(SimOta, TakesTheRightCellWhereOneIsEnough) {
  std::vector<CellPrediction> cells;
  for (int column = 0; column < 12; ++column) cells.push_back(Cell(4, column, 16));
  EXPECT_THAT(AssignSimOta(cells, cells[5].Box()), ElementsAre(5));
}

// Five cells predict the target itself: k = 5. They come by score; the three tiny ones are left
// out, though their scores are better.
TEST(SimOta, TakesAsManyCellsAsOverlapWell) {
  const image_box_t target = {35.5, 35.5, 40, 40};
  std::vector<CellPrediction> cells;
  for (int i = 0; i < 8; ++i) {
    CellPrediction cell = Cell(4, 2 + i % 5, 40, 0.1 * i);
    cell.reg_x = 4.5 - cell.column;  // All around the cell in column 4.
    if (i >= 5) cell.reg_w = cell.reg_h = std::log(1e-3);
    cells.push_back(cell);
  }
  EXPECT_THAT(AssignSimOta(cells, target), ElementsAre(4, 3, 2, 1, 0));
}

TEST(SimOta, TakesNoCellFromAfar) {
  EXPECT_THAT(AssignSimOta(std::vector{Cell(0, 0, 16)}, {100, 100, 10, 10}), IsEmpty());
}

/// Outputs of a batch on 64 × 32 px, strides 8 and 16.
struct Batch {
  explicit Batch(std::size_t n_images) {
    for (const int stride : {8, 16}) {
      const std::size_t cells = 64 * 32 / static_cast<std::size_t>(stride * stride);
      raw.emplace_back(n_images * 6 * cells, 0.0f);
      gradient.emplace_back(n_images * 6 * cells, -1.0f);
    }
    targets.resize(n_images);
  }
  YoloxLossParts Loss() {
    const std::vector<LevelOutput> levels = {{8, 4, 8, raw[0], gradient[0]},
                                             {16, 2, 4, raw[1], gradient[1]}};
    return YoloxLoss(levels, targets);
  }
  std::vector<std::vector<float>> raw, gradient;
  std::vector<std::optional<image_box_t>> targets;
};

// Nothing to find: each of the 40 cells says "even odds", which costs log 2.
TEST(YoloxLoss, OfAnEmptyImageIsThatOfItsScores) {
  Batch batch(1);
  const YoloxLossParts loss = batch.Loss();
  EXPECT_NEAR(loss.Total(), 40 * std::log(2.0), 1e-9);
  EXPECT_EQ(loss.n_assigned, 0);
  EXPECT_FLOAT_EQ(batch.gradient[0][4 * 32], 0.5f);  // Objectness of the first cell.
  EXPECT_FLOAT_EQ(batch.gradient[0][0], 0);
}

// The only cell that sees the target is right: no box error, and the class learns overlap 1.
TEST(YoloxLoss, OfARightBoxIsThatOfItsScores) {
  Batch batch(1);
  std::fill(batch.raw[0].begin(), batch.raw[0].end(), 0.0f);
  const std::size_t cell = 1 * 8 + 3, area = 32;
  batch.raw[0][0 * area + cell] = batch.raw[0][1 * area + cell] = 0.5f;
  batch.targets[0] = image_box_t{3.5 * 8 - 0.5, 1.5 * 8 - 0.5, 8, 8};
  const YoloxLossParts loss = batch.Loss();
  EXPECT_EQ(loss.n_assigned, 1);
  EXPECT_NEAR(loss.box, 0, 1e-9);
  EXPECT_NEAR(loss.offset, 0, 1e-9);
  EXPECT_NEAR(loss.cls, std::log(2.0), 1e-9);
  EXPECT_NEAR(loss.objectness, 40 * std::log(2.0), 1e-9);
}

TEST(YoloxLoss, RefusesOutputsOfAnotherShape) {
  Batch batch(1);
  batch.raw[1].pop_back();
  EXPECT_THROW(batch.Loss(), std::invalid_argument);
}

// --- Numeric derivative. -------------------------------------------------------------------------

// The class learns an overlap that counts as given, so the loss that is differentiated is that of
// box, offset and objectness; the class's gradient has the worked example above.
TEST(YoloxLoss, GradientIsTheDerivative) {
  Batch batch(2);
  RandomStream random(5, "test/raw");
  for (auto& level : batch.raw) {
    for (float& value : level) value = static_cast<float>(0.4 * random.Normal());
  }
  batch.targets[0] = image_box_t{30, 14, 19, 13};
  batch.Loss();
  const auto gradient = batch.gradient;
  int n_moving = 0;
  for (std::size_t level = 0; level < 2; ++level) {
    const std::size_t area = level == 0 ? 32 : 8;
    for (std::size_t i = 0; i < batch.raw[level].size(); ++i) {
      if (i / area % 6 == 5) continue;
      const float middle = batch.raw[level][i];
      const auto at = [&](float offset) {
        batch.raw[level][i] = middle + offset;
        const YoloxLossParts loss = batch.Loss();
        return loss.box + loss.offset + loss.objectness;
      };
      const double numeric = (at(1e-3f) - at(-1e-3f)) / 2e-3;
      batch.raw[level][i] = middle;
      // Curvature times 1e-6, and float's rounding of ±1e-3 (6e-5 of it).
      ASSERT_NEAR(gradient[level][i], numeric, 1e-4 + 2e-4 * std::abs(numeric))
          << level << ' ' << i;
      n_moving += i / area % 6 < 4 && gradient[level][i] != 0 ? 1 : 0;
    }
  }
  EXPECT_GE(n_moving, 4);
}

// --- Folding. ------------------------------------------------------------------------------------

// y = gamma (w x - mean) / sqrt(variance + epsilon) + beta.
TEST(LearnedNetwork, FoldsBatchNormalisation) {
  Layer input{.kind = LayerKind::kInput, .name = "images", .inputs = {}, .channels = 1};
  Layer conv{.kind = LayerKind::kConv, .name = "a", .inputs = {0}, .channels = 2};
  conv.batch_norm = true;
  Layer plain{.kind = LayerKind::kConv, .name = "b", .inputs = {1}, .channels = 1};
  const LayerTable table{.name = "t", .layers = {input, conv, plain}, .outputs = {2}};
  const LearnedNetwork network{.parameters = {3, 5, /*gamma*/ 2, 1, /*beta*/ 7, 8,
                                              /*b*/ 0.25f, 0.5f, 9},
                               .statistics = {10, 20, 4 - kNormEpsilon, 1 - kNormEpsilon}};
  const NetworkWeights folded = Folded(table, network);
  CheckWeights(table, folded);
  EXPECT_THAT(folded.layers[1].weight, ElementsAre(3, 5));
  EXPECT_THAT(folded.layers[1].bias, ElementsAre(7 - 10, 8 - 20));
  EXPECT_THAT(folded.layers[2].weight, ElementsAre(0.25f, 0.5f));
  EXPECT_THAT(folded.layers[2].bias, ElementsAre(9));
}

TEST(LearnedNetwork, HasAsManyNumbersAsTheTableSays) {
  for (const std::string& name : kYoloxNetworks) {
    const LayerTable table = MakeYolox(name).table;
    const LearnedNetwork network = InitialNetwork(table, 1);
    EXPECT_EQ(std::ssize(network.parameters), ParameterCount(table));
    CheckWeights(table, Folded(table, network));
  }
}

}  // namespace
}  // namespace windhover
