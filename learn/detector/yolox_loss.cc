#include "learn/detector/yolox_loss.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace windhover {
namespace {

constexpr int kNumbers = 6;
constexpr double kLargestLogSize = 6;  // exp(6) strides: larger than any image.
constexpr double kCentreRadius = 2.5;  // Strides.
constexpr std::size_t kCountedOverlaps = 10;
constexpr double kOverlapCost = 3, kOutsideCost = 1e5;
constexpr double kBoxWeight = 5;
constexpr double kMinSize_px = 1e-3;

double SideOf(double log_size, int stride) {
  return std::exp(std::min(log_size, kLargestLogSize)) * stride;
}

double Sigmoid(double x) { return 1 / (1 + std::exp(-x)); }

/// -log of the probability that sigmoid(logit) gives to `target`.
double CrossEntropy(double logit, double target) {
  return std::max(logit, 0.0) - logit * target + std::log1p(std::exp(-std::abs(logit)));
}

// (0, 0) is the centre of a pixel, so the middle of the first cell is at (stride - 1) / 2.
double CellCentre(int index, int stride) { return (index + 0.5) * stride - 0.5; }

bool IsNear(const CellPrediction& cell, const image_box_t& box, double half_w, double half_h) {
  return std::abs(CellCentre(cell.column, cell.stride) - box.x_px) < half_w &&
         std::abs(CellCentre(cell.row, cell.stride) - box.y_px) < half_h;
}

bool IsInside(const CellPrediction& cell, const image_box_t& box) {
  return IsNear(cell, box, box.w_px / 2, box.h_px / 2);
}

bool IsCentral(const CellPrediction& cell, const image_box_t& box) {
  return IsNear(cell, box, kCentreRadius * cell.stride, kCentreRadius * cell.stride);
}

double CostOf(const CellPrediction& cell, const image_box_t& target, double overlap) {
  // As in YOLOX: of sqrt(obj · cls), which is the score's square root.
  const double p = std::sqrt(Sigmoid(cell.cls) * Sigmoid(cell.obj));
  const bool both = IsInside(cell, target) && IsCentral(cell, target);
  return -std::log(p + 1e-12) - kOverlapCost * std::log(overlap + 1e-8) + (both ? 0 : kOutsideCost);
}

/// Length of [a ± la/2] ∩ [b ± lb/2], and its derivatives by a and la.
struct Shared {
  double length, by_centre, by_length;
};

Shared SharedLength(double a, double la, double b, double lb) {
  const double high = std::min(a + la / 2, b + lb / 2), low = std::max(a - la / 2, b - lb / 2);
  if (high <= low) return {0, 0, 0};
  const double own_high = a + la / 2 < b + lb / 2 ? 1 : 0,
               own_low = a - la / 2 > b - lb / 2 ? 1 : 0;
  return {high - low, own_high - own_low, 0.5 * (own_high + own_low)};
}

struct Overlap {
  double value;
  std::array<double, 4> gradient;  ///< By x, y, w, h of the first box.
};

Overlap OverlapWithGradient(const image_box_t& a, const image_box_t& b) {
  const Shared x = SharedLength(a.x_px, a.w_px, b.x_px, b.w_px);
  const Shared y = SharedLength(a.y_px, a.h_px, b.y_px, b.h_px);
  const double both = x.length * y.length;
  const double either = a.w_px * a.h_px + b.w_px * b.h_px - both;
  // d(both / either), with either = areas - both.
  const auto derivative = [&](double d_both, double d_area) {
    return (d_both * (either + both) - both * d_area) / (either * either);
  };
  return {both / either,
          {derivative(x.by_centre * y.length, 0), derivative(y.by_centre * x.length, 0),
           derivative(x.by_length * y.length, a.h_px), derivative(y.by_length * x.length, a.w_px)}};
}

/// Where the numbers of a batch's cells are.
class Outputs {
 public:
  Outputs(std::span<const LevelOutput> levels, std::size_t n_images) : levels_(levels) {
    for (const LevelOutput& level : levels) {
      if (level.raw.size() != n_images * kNumbers * Area(level) ||
          level.gradient.size() != level.raw.size()) {
        throw std::invalid_argument("a level's outputs do not fill its shape");
      }
    }
  }

  std::vector<CellPrediction> Cells(std::size_t image) const {
    std::vector<CellPrediction> cells;
    for (const LevelOutput& level : levels_) {
      for (std::size_t i = 0; i < Area(level); ++i) {
        const float* raw = &level.raw[image * kNumbers * Area(level) + i];
        const auto number = [&](std::size_t n) { return double{raw[n * Area(level)]}; };
        cells.push_back({level.stride, static_cast<int>(i) / level.columns,
                         static_cast<int>(i) % level.columns, number(0), number(1), number(2),
                         number(3), number(4), number(5)});
      }
    }
    return cells;
  }

  /// Writes a cell's gradient; `cell` counts as in Cells().
  void SetGradient(std::size_t image, std::size_t cell,
                   const std::array<double, kNumbers>& gradient) const {
    std::size_t l = 0;
    for (; cell >= Area(levels_[l]); ++l) cell -= Area(levels_[l]);
    const std::size_t area = Area(levels_[l]);
    for (std::size_t n = 0; n < kNumbers; ++n) {
      levels_[l].gradient[(image * kNumbers + n) * area + cell] = static_cast<float>(gradient[n]);
    }
  }

 private:
  static std::size_t Area(const LevelOutput& level) {
    return static_cast<std::size_t>(level.rows) * static_cast<std::size_t>(level.columns);
  }

  std::span<const LevelOutput> levels_;
};

/// What the raw box of a cell would be if it were right.
std::array<double, 4> RawOf(const image_box_t& box, const CellPrediction& cell) {
  const double s = cell.stride;
  return {(box.x_px + 0.5) / s - cell.column, (box.y_px + 0.5) / s - cell.row,
          std::log(std::max(box.w_px, kMinSize_px) / s),
          std::log(std::max(box.h_px, kMinSize_px) / s)};
}

/// Adds the losses of a cell that learns `target`, times `weight`; sets the gradient of its box.
double AddBoxLoss(const CellPrediction& cell, const image_box_t& target, double weight,
                  YoloxLossParts* parts, std::array<double, kNumbers>* gradient) {
  const image_box_t box = cell.Box();
  const Overlap overlap = OverlapWithGradient(box, target);
  parts->box += weight * kBoxWeight * (1 - overlap.value * overlap.value);
  const std::array<double, 4> raw = {cell.reg_x, cell.reg_y, cell.reg_w, cell.reg_h};
  const std::array<double, 4> px_by_raw = {double(cell.stride), double(cell.stride),
                                           cell.reg_w < kLargestLogSize ? box.w_px : 0,
                                           cell.reg_h < kLargestLogSize ? box.h_px : 0};
  const std::array<double, 4> wanted = RawOf(target, cell);
  for (std::size_t n = 0; n < 4; ++n) {
    const double off = raw[n] - wanted[n];
    parts->offset += weight * std::abs(off);
    (*gradient)[n] =
        weight *
        (-2 * kBoxWeight * overlap.value * overlap.gradient[n] * px_by_raw[n] + (off > 0 ? 1 : -1));
  }
  return overlap.value;
}

void AddImage(const Outputs& outputs, std::size_t image, std::span<const CellPrediction> cells,
              const std::vector<int>& assigned, const image_box_t* target, double weight,
              YoloxLossParts* parts) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool learns =
        std::find(assigned.begin(), assigned.end(), static_cast<int>(i)) != assigned.end();
    std::array<double, kNumbers> gradient{};
    if (learns) {
      const double overlap = AddBoxLoss(cells[i], *target, weight, parts, &gradient);
      parts->cls += weight * CrossEntropy(cells[i].cls, overlap);
      gradient[5] = weight * (Sigmoid(cells[i].cls) - overlap);
    }
    parts->objectness += weight * CrossEntropy(cells[i].obj, learns ? 1 : 0);
    gradient[4] = weight * (Sigmoid(cells[i].obj) - (learns ? 1 : 0));
    outputs.SetGradient(image, i, gradient);
  }
}

}  // namespace

image_box_t CellPrediction::Box() const {
  return {(column + reg_x) * stride - 0.5, (row + reg_y) * stride - 0.5, SideOf(reg_w, stride),
          SideOf(reg_h, stride)};
}

std::vector<int> AssignSimOta(std::span<const CellPrediction> cells, const image_box_t& target) {
  struct Candidate {
    int index;
    double cost;
  };
  std::vector<Candidate> candidates;
  std::vector<double> overlaps;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!IsInside(cells[i], target) && !IsCentral(cells[i], target)) continue;
    overlaps.push_back(OverlapWithGradient(cells[i].Box(), target).value);
    candidates.push_back({static_cast<int>(i), CostOf(cells[i], target, overlaps.back())});
  }
  std::sort(overlaps.rbegin(), overlaps.rend());
  overlaps.resize(std::min(overlaps.size(), kCountedOverlaps));
  const double sum = std::accumulate(overlaps.begin(), overlaps.end(), 0.0);
  const auto k = std::min(candidates.size(), static_cast<std::size_t>(std::max(sum, 1.0)));
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
  std::vector<int> assigned;
  for (std::size_t i = 0; i < k; ++i) assigned.push_back(candidates[i].index);
  return assigned;
}

YoloxLossParts YoloxLoss(std::span<const LevelOutput> levels,
                         std::span<const std::optional<image_box_t>> targets) {
  const Outputs outputs(levels, targets.size());
  std::vector<std::vector<CellPrediction>> cells;
  std::vector<std::vector<int>> assigned(targets.size());
  YoloxLossParts parts;
  for (std::size_t image = 0; image < targets.size(); ++image) {
    cells.push_back(outputs.Cells(image));
    if (targets[image]) assigned[image] = AssignSimOta(cells[image], *targets[image]);
    parts.n_assigned += static_cast<int>(assigned[image].size());
  }
  const double weight = 1.0 / std::max(parts.n_assigned, 1);
  for (std::size_t image = 0; image < targets.size(); ++image) {
    AddImage(outputs, image, cells[image], assigned[image],
             targets[image] ? &*targets[image] : nullptr, weight, &parts);
  }
  return parts;
}

}  // namespace windhover
