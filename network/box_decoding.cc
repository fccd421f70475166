#include "network/box_decoding.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace windhover {
namespace {

constexpr float kMaxLogSize = 12;  // exp() of more is larger than any image.

double Sigmoid(double x) { return 1 / (1 + std::exp(-x)); }

double Overlap1d(double a, double a_length, double b, double b_length) {
  return std::min(a + a_length / 2, b + b_length / 2) -
         std::max(a - a_length / 2, b - b_length / 2);
}

/// The numbers of one cell, in the order in which the network gives them.
struct Cell {
  float x, y, w, h, objectness, aircraft;

  bool IsFinite() const { return std::isfinite(x + y + w + h + objectness + aircraft); }
};

void DecodeLevel(const YoloxLevel& level, double min_score, std::vector<ScoredBox>* boxes) {
  const auto n = static_cast<std::size_t>(level.height) * static_cast<std::size_t>(level.width);
  if (level.values.size() != 6 * n) throw std::runtime_error("a network without boxes");
  const float* v = level.values.data();
  // Both factors of a score are below 1: where one logit is too low nothing else is looked at.
  const double min_logit = std::log(min_score / (1 - min_score));
  for (std::size_t i = 0; i < n; ++i) {
    const Cell cell{v[i], v[n + i], v[2 * n + i], v[3 * n + i], v[4 * n + i], v[5 * n + i]};
    if (!cell.IsFinite()) throw std::runtime_error("the network gave numbers that are not finite");
    if (cell.objectness < min_logit || cell.aircraft < min_logit) continue;
    const double score = Sigmoid(cell.objectness) * Sigmoid(cell.aircraft);
    if (score < min_score) continue;
    const int row = static_cast<int>(i) / level.width, column = static_cast<int>(i) % level.width;
    ScoredBox box{.score = score};
    box.box.x_px = (column + double{cell.x}) * level.stride - 0.5;
    box.box.y_px = (row + double{cell.y}) * level.stride - 0.5;
    box.box.w_px = std::exp(double{std::min(cell.w, kMaxLogSize)}) * level.stride;
    box.box.h_px = std::exp(double{std::min(cell.h, kMaxLogSize)}) * level.stride;
    const double width = level.width * level.stride, height = level.height * level.stride;
    const bool inside = box.box.x_px >= -0.5 && box.box.y_px >= -0.5 &&
                        box.box.x_px <= width - 0.5 && box.box.y_px <= height - 0.5;
    if (inside && box.box.w_px <= 4 * width && box.box.h_px <= 4 * height) boxes->push_back(box);
  }
}

}  // namespace

std::vector<ScoredBox> DecodeBoxes(std::span<const YoloxLevel> levels, double min_score) {
  std::vector<ScoredBox> boxes;
  for (const YoloxLevel& level : levels) DecodeLevel(level, min_score, &boxes);
  return boxes;
}

double OverlapOf(const image_box_t& a, const image_box_t& b) {
  const double w = Overlap1d(a.x_px, a.w_px, b.x_px, b.w_px);
  const double h = Overlap1d(a.y_px, a.h_px, b.y_px, b.h_px);
  if (w <= 0 || h <= 0) return 0;
  return w * h / (a.w_px * a.h_px + b.w_px * b.h_px - w * h);
}

std::vector<ScoredBox> WithoutDoubles(std::vector<ScoredBox> boxes, double max_overlap,
                                      std::size_t most) {
  std::stable_sort(boxes.begin(), boxes.end(),
                   [](const ScoredBox& a, const ScoredBox& b) { return a.score > b.score; });
  std::vector<ScoredBox> kept;
  for (const ScoredBox& box : boxes) {
    if (kept.size() == most) break;
    const bool is_double = std::any_of(kept.begin(), kept.end(), [&](const ScoredBox& better) {
      return OverlapOf(box.box, better.box) > max_overlap;
    });
    if (!is_double) kept.push_back(box);
  }
  return kept;
}

}  // namespace windhover
