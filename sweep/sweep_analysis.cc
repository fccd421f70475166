#include "sweep/sweep_analysis.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "eval/score_metric.h"
#include "sweep/pareto.h"

namespace windhover {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kMapSize = 61;
constexpr int kIndexSamples = 4096;
constexpr Index kMostPoints = 2000;  // Of one surface; time goes with the cube.
constexpr std::size_t kMostFactors = 8;
constexpr double kSure = 1.96;

std::size_t IndexOf(const std::vector<std::string>& metrics, const std::string& metric) {
  const auto at = std::find(metrics.begin(), metrics.end(), metric);
  return at == metrics.end() ? 0 : static_cast<std::size_t>(at - metrics.begin());
}

/// Mean of a metric at the points that differ from the first, the base, in factor `f` at most, with
/// its values there.
std::vector<std::pair<std::string, double>> AlongFactor(const SweepPlan& plan,
                                                        const std::vector<PointSummary>& points,
                                                        std::size_t metric, std::size_t f) {
  std::vector<std::pair<std::string, double>> along;
  for (const PointSummary& point : points) {
    const DesignPoint& at = plan.points[static_cast<std::size_t>(point.point)];
    DesignPoint base = plan.points.front();
    base[f] = at[f];
    const auto& mean = point.metrics[metric].mean;
    if (mean && at == base) along.emplace_back(at[f], *mean);
  }
  // Words stay in their order.
  std::stable_sort(along.begin(), along.end(), [](const auto& a, const auto& b) {
    const auto x = NumberOf(a.first), y = NumberOf(b.first);
    return x && y && *x < *y;
  });
  return along;
}

/// Analyses one sweep, step by step.
class Analyst {
 public:
  Analyst(const SweepPlan& plan, const std::vector<PointSummary>& points)
      : plan_(plan), points_(points) {}

  SweepAnalysis Analyse() {
    const AnalysisConfig& config = plan_.config.analysis;
    Response& response = analysis_.response;
    response = MakeResponse(plan_, points_, IndexOf(plan_.metrics, config.metric));
    if (!std::isnan(config.limit)) analysis_.limit = config.limit;
    ChooseAxes();
    for (const ResponseGroup& group : response.groups) FitGroup(group);
    if (IsOneAtATime()) {
      FindEffectsOfPoints(IndexOf(plan_.metrics, config.metric));
    } else if (!response.groups.empty()) {
      FindIndices();
      FindEffects();
    }
    if (config.pareto.size() == 2) FindFront();
    return std::move(analysis_);
  }

 private:
  const std::vector<CodedFactor>& numbers() const { return analysis_.response.numbers; }

  /// Points that say nothing about two factors together: no surface goes through them.
  bool IsOneAtATime() const {
    return plan_.config.design.type == DesignType::kOneAtATime && plan_.factors.size() > 1;
  }

  std::size_t NumberNamed(const std::string& key, std::size_t otherwise) const {
    for (std::size_t i = 0; i < numbers().size(); ++i) {
      if (numbers()[i].key == key) return i;
    }
    return otherwise;
  }

  void ChooseAxes() {
    analysis_.x = NumberNamed(plan_.config.analysis.x, 0);
    analysis_.y = NumberNamed(plan_.config.analysis.y, analysis_.x == 0 ? 1 : 0);
  }

  /// The middle of every factor, with x and y at theirs.
  VectorXd At(double x, double y) const {
    VectorXd at = VectorXd::Constant(static_cast<Index>(numbers().size()), 0.5);
    if (analysis_.x < numbers().size()) at[static_cast<Index>(analysis_.x)] = x;
    if (analysis_.y < numbers().size()) at[static_cast<Index>(analysis_.y)] = y;
    return at;
  }

  void FitGroup(const ResponseGroup& group) {
    GroupAnalysis& result = analysis_.groups.emplace_back();
    result.name = group.Name();
    if (numbers().empty() || group.x.rows() > kMostPoints || IsOneAtATime()) return;
    const auto surface = std::make_shared<GaussianProcess>(group.x, group.y, group.sigma);
    result.surface = surface;
    std::vector<std::string> names;
    for (const CodedFactor& number : numbers()) names.push_back(number.key);
    result.quadratic = FitQuadraticSurface(group.x, group.y, names);
    if (numbers().size() < 2) return FindLargest(0.5, *surface, &result);
    result.map =
        MakeMap(kMapSize, kMapSize, [&](double x, double y) { return surface->MeanAt(At(x, y)); });
    std::set<double> values;
    for (const double y : group.x.col(static_cast<Index>(analysis_.y))) values.insert(y);
    // Of a random design every value is another.
    if (values.size() > 30) values = {0, 0.25, 0.5, 0.75, 1};
    for (const double y : values) FindLargest(y, *surface, &result);
  }

  void FindLargest(double y, const GaussianProcess& surface, GroupAnalysis* result) const {
    if (!analysis_.limit) return;
    const CodedFactor& of_x = numbers()[analysis_.x];
    LargestValue largest{.y = numbers().size() < 2 ? 0 : numbers()[analysis_.y].Decode(y)};
    const auto mean = [&](double x) { return surface.MeanAt(At(x, y)); };
    const auto sure = [&](double x) {
      const auto [value, sigma] = surface.At(At(x, y));
      return value + kSure * sigma;
    };
    const auto x = LargestWithin(mean, *analysis_.limit, 200);
    const auto sure_x = LargestWithin(sure, *analysis_.limit, 200);
    if (x) largest.x = of_x.Decode(*x);
    if (sure_x) largest.sure_x = of_x.Decode(*sure_x);
    largest.is_end = x && *x >= 1;
    result->largest.push_back(largest);
  }

  /// The response at shares u of the factors' distributions; words choose the surface.
  double ResponseAt(const std::vector<double>& u) const {
    VectorXd x(static_cast<Index>(numbers().size()));
    for (std::size_t i = 0; i < numbers().size(); ++i) {
      const std::size_t f = numbers()[i].factor;
      x[static_cast<Index>(i)] = numbers()[i].Code(NumberOf(plan_.factors[f].At(u[f])).value_or(0));
    }
    std::vector<std::string> words;
    for (const std::size_t f : analysis_.response.words) {
      words.push_back(plan_.factors[f].At(u[f]));
    }
    const auto& groups = analysis_.response.groups;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (groups[g].words == words) return GroupAt(g, x);
    }
    return GroupAt(0, x);
  }

  double GroupAt(std::size_t group, const VectorXd& x) const {
    const auto& surface = analysis_.groups[group].surface;
    return surface ? surface->MeanAt(x) : analysis_.response.groups[group].y.mean();
  }

  bool HasAllSurfaces() const {
    // A design that leaves combinations of words out has no surface for them.
    std::size_t n = 1;
    for (const std::size_t f : analysis_.response.words) n *= plan_.factors[f].Levels().size();
    return analysis_.groups.size() == n &&
           std::all_of(analysis_.groups.begin(), analysis_.groups.end(),
                       [](const GroupAnalysis& group) { return group.surface != nullptr; });
  }

  void FindIndices() {
    for (const Factor& factor : plan_.factors) analysis_.keys.push_back(factor.key());
    if (plan_.factors.empty() || plan_.factors.size() > kMostFactors || !HasAllSurfaces()) return;
    analysis_.indices =
        ComputeSobolIndices(static_cast<int>(plan_.factors.size()), kIndexSamples,
                            [this](const std::vector<double>& u) { return ResponseAt(u); });
  }

  void FindEffects() {
    if (!HasAllSurfaces()) return;
    // The middle of a list of two is the second: what is compared is the first with the last.
    std::vector<double> middle(plan_.factors.size(), 0.5);
    for (std::size_t f = 0; f < plan_.factors.size(); ++f) {
      constexpr double kLow = 0.05, kHigh = 0.95;
      std::vector<double> low = middle, high = middle;
      low[f] = kLow;
      high[f] = kHigh;
      analysis_.effects.push_back({.key = plan_.factors[f].key(),
                                   .low = plan_.factors[f].At(kLow),
                                   .high = plan_.factors[f].At(kHigh),
                                   .at_low = ResponseAt(low),
                                   .at_high = ResponseAt(high)});
    }
    SortEffects();
  }

  void FindEffectsOfPoints(std::size_t metric) {
    for (std::size_t f = 0; f < plan_.factors.size(); ++f) {
      const auto along = AlongFactor(plan_, points_, metric, f);
      if (along.size() < 2) continue;
      analysis_.effects.push_back({.key = plan_.factors[f].key(),
                                   .low = along.front().first,
                                   .high = along.back().first,
                                   .at_low = along.front().second,
                                   .at_high = along.back().second});
    }
    SortEffects();
  }

  void SortEffects() {
    std::stable_sort(analysis_.effects.begin(), analysis_.effects.end(),
                     [](const FactorEffect& a, const FactorEffect& b) {
                       return std::abs(a.at_high - a.at_low) > std::abs(b.at_high - b.at_low);
                     });
  }

  void FindFront() {
    std::array<std::size_t, 2> metric;
    std::array<double, 2> sign;
    for (const std::size_t i : {0, 1}) {
      metric[i] = IndexOf(plan_.metrics, plan_.config.analysis.pareto[i]);
      sign[i] = MoreIsBetter(plan_.metrics[metric[i]]) ? -1 : 1;
    }
    std::vector<std::array<double, 2>> values;
    for (const PointSummary& point : points_) {
      const auto &a = point.metrics[metric[0]].mean, &b = point.metrics[metric[1]].mean;
      if (!a || !b) continue;
      analysis_.all.push_back({point.point, *a, *b});
      values.push_back({sign[0] * *a, sign[1] * *b});
    }
    for (const std::size_t i : ParetoFront(values)) analysis_.front.push_back(analysis_.all[i]);
  }

  const SweepPlan& plan_;
  const std::vector<PointSummary>& points_;
  SweepAnalysis analysis_;
};

}  // namespace

SweepAnalysis AnalyseSweep(const SweepPlan& plan, const std::vector<PointSummary>& points) {
  return Analyst(plan, points).Analyse();
}

}  // namespace windhover
