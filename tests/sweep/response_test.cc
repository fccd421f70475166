#include "sweep/response.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/random/random_stream.h"
#include "sweep/gaussian_process.h"
#include "sweep/pareto.h"
#include "sweep/quadratic_surface.h"
#include "sweep/response_map.h"
#include "sweep/sobol_indices.h"
#include "sweep/sobol_sequence.h"
#include "sweep/sweep_analysis.h"
#include "sweep/sweep_figures.h"
#include "sweep/sweep_report.h"

namespace windhover {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::ElementsAre;
using testing::HasSubstr;

MatrixXd Spread(Index n, int d) {
  const SobolSequence sequence(d);
  MatrixXd x(n, d);
  for (Index i = 0; i < n; ++i) {
    const auto point = sequence.Point(static_cast<std::uint32_t>(i));
    for (int k = 0; k < d; ++k) x(i, k) = point[static_cast<std::size_t>(k)];
  }
  return x;
}

template <typename Function>
VectorXd Values(const MatrixXd& x, const Function& f) {
  VectorXd y(x.rows());
  for (Index i = 0; i < x.rows(); ++i) y[i] = f(x.row(i).transpose());
  return y;
}

// With u = 2a − 1, v = 2b − 1: 3 + 2u − uv + 0.5 v².
TEST(QuadraticSurface, FindsTheCoefficientsOfAQuadratic) {
  const MatrixXd x = Spread(20, 2);
  const VectorXd y = Values(x, [](const VectorXd& p) {
    const double u = 2 * p[0] - 1, v = 2 * p[1] - 1;
    return 3 + 2 * u - u * v + 0.5 * v * v;
  });
  const QuadraticSurface surface = FitQuadraticSurface(x, y, {"a", "b"});
  const std::vector<std::pair<std::string, double>> expected = {
      {"1", 3}, {"a", 2}, {"b", 0}, {"a · b", -1}, {"a²", 0}, {"b²", 0.5}};
  ASSERT_EQ(surface.terms.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(surface.terms[i].name, expected[i].first);
    EXPECT_NEAR(surface.terms[i].coefficient, expected[i].second, 1e-9);
  }
  EXPECT_NEAR(surface.r_squared, 1, 1e-12);
  EXPECT_NEAR(surface.leave_one_out_rmse, 0, 1e-9);
}

// The residual without a point, by the hat matrix, is that of a fit without it.
TEST(QuadraticSurface, LeavesOneOutAsAFitWithoutItDoes) {
  const MatrixXd x = Spread(12, 1);
  const VectorXd y = Values(x, [](const VectorXd& p) { return std::exp(3 * p[0]); });
  double sum = 0;
  for (Index out = 0; out < 12; ++out) {
    MatrixXd rest_x(11, 1);
    VectorXd rest_y(11);
    for (Index i = 0, k = 0; i < 12; ++i) {
      if (i == out) continue;
      rest_x(k, 0) = x(i, 0);
      rest_y[k++] = y[i];
    }
    const auto terms = FitQuadraticSurface(rest_x, rest_y, {"a"}).terms;
    const double u = 2 * x(out, 0) - 1;
    sum += std::pow(
        y[out] - terms[0].coefficient - terms[1].coefficient * u - terms[2].coefficient * u * u, 2);
  }
  EXPECT_NEAR(FitQuadraticSurface(x, y, {"a"}).leave_one_out_rmse, std::sqrt(sum / 12), 1e-9);
}

TEST(QuadraticSurface, HasNoTermsWithoutPointsForThem) {
  const MatrixXd x = Spread(5, 2);
  EXPECT_TRUE(FitQuadraticSurface(x, VectorXd::Zero(5), {"a", "b"}).terms.empty());
}

// Smooth and known: 40 points of a bump of width 0.3 predict it to 1 % of its height.
TEST(GaussianProcess, PredictsASmoothFunction) {
  const auto bump = [](const VectorXd& p) {
    return 2 + std::exp(-(p - VectorXd::Constant(2, 0.4)).squaredNorm() / 0.18);
  };
  const MatrixXd x = Spread(40, 2);
  const GaussianProcess process(x, Values(x, bump), VectorXd::Zero(40));
  RandomStream random(1, "test");
  for (int i = 0; i < 200; ++i) {
    const VectorXd at = VectorXd::NullaryExpr(2, [&] { return random.Uniform(0.05, 0.95); });
    EXPECT_NEAR(process.MeanAt(at), bump(at), 0.01);
    EXPECT_EQ(process.MeanAt(at), process.At(at).mean);
  }
  EXPECT_LT(process.leave_one_out_rmse(), 0.02);
}

// Noise of 0.1: the mean smooths it (nearer to the truth than the data are), and 1.96 sigma hold
// the truth in about 95 % of places; 85 allows for one sample of noise.
TEST(GaussianProcess, KnowsItsOwnError) {
  RandomStream random(2, "test");
  const auto truth = [](const VectorXd& p) { return std::sin(4 * p[0]); };
  const MatrixXd x = Spread(60, 1);
  VectorXd y = Values(x, truth);
  for (double& value : y) value += 0.1 * random.Normal();
  const GaussianProcess process(x, y, VectorXd::Constant(60, 0.1));
  int held = 0;
  double squares = 0;
  for (int i = 0; i < 100; ++i) {
    const VectorXd at = VectorXd::Constant(1, (i + 0.5) / 100);
    const auto [mean, sigma] = process.At(at);
    held += std::abs(mean - truth(at)) < 1.96 * sigma ? 1 : 0;
    squares += std::pow(mean - truth(at), 2) / 100;
  }
  EXPECT_GE(held, 85);
  EXPECT_LT(std::sqrt(squares), 0.05);
}

TEST(GaussianProcess, TakesAConstant) {
  const MatrixXd x = Spread(8, 2);
  const GaussianProcess process(x, VectorXd::Constant(8, 3), VectorXd::Zero(8));
  EXPECT_NEAR(process.MeanAt(VectorXd::Constant(2, 0.3)), 3, 1e-9);
}

// T. Ishigami and T. Homma, ISUMA '90: sin a + 7 sin² b + 0.1 c⁴ sin a over [−π, π]³ has
// S = 0.3139, 0.4424, 0 and S_T = 0.5576, 0.4424, 0.2437.
TEST(SobolIndices, OfIshigamisFunctionAreThePublished) {
  const auto f = [](const std::vector<double>& u) {
    const auto x = [&](std::size_t i) { return std::numbers::pi * (2 * u[i] - 1); };
    return std::sin(x(0)) + 7 * std::pow(std::sin(x(1)), 2) +
           0.1 * std::pow(x(2), 4) * std::sin(x(0));
  };
  const SobolIndices indices = ComputeSobolIndices(3, 8192, f);
  const double first[] = {0.3139, 0.4424, 0}, total[] = {0.5576, 0.4424, 0.2437};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(indices.first[i], first[i], 0.01) << i;
    EXPECT_NEAR(indices.total[i], total[i], 0.01) << i;
  }
  EXPECT_NEAR(indices.mean, 3.5, 0.01);
}

TEST(ResponseMap, ContourOfACircleIsACircle) {
  const ResponseMap map =
      MakeMap(81, 81, [](double x, double y) { return std::hypot(x - 0.5, y - 0.5); });
  double length = 0;
  for (const auto& [x1, y1, x2, y2] : ContourOf(map, 0.3)) {
    EXPECT_NEAR(std::hypot(x1 - 0.5, y1 - 0.5), 0.3, 1e-3);  // Linear within a cell of 1/80.
    length += std::hypot(x2 - x1, y2 - y1);
  }
  EXPECT_NEAR(length, 2 * std::numbers::pi * 0.3, 0.01);
  EXPECT_TRUE(ContourOf(map, 2).empty());
}

TEST(ResponseMap, LargestWithinStopsWhereTheLimitIsFirstPassed) {
  EXPECT_NEAR(*LargestWithin([](double x) { return x * x; }, 0.25, 100), 0.5, 1e-4);
  EXPECT_EQ(*LargestWithin([](double x) { return x; }, 2, 10), 1);
  EXPECT_FALSE(LargestWithin([](double x) { return 1 - x; }, 0.5, 10)) << "above at 0";
  EXPECT_NEAR(*LargestWithin([](double x) { return std::sin(10 * x); }, 0.5, 1000),
              std::numbers::pi / 60, 1e-4)
      << "it comes back below later";
}

TEST(ParetoFront, HasWhatNothingBeats) {
  EXPECT_THAT(ParetoFront({{1, 5}, {2, 2}, {3, 3}, {4, 1}, {2, 4}, {2, 2}}),
              ElementsAre(0, 1, 5, 3));
  EXPECT_TRUE(ParetoFront({}).empty());
}

/// A sweep of two words and two numbers with response = (word b: 2) · (x + 0.1 y).
class Analysis : public testing::Test {
 protected:
  Analysis() {
    plan_.config.analysis = {.limit = 5, .x = "x", .y = "y", .pareto = {"m", "detected"}};
    plan_.factors.emplace_back(FactorConfig{.key = "w", .values = {"a", "b"}});
    plan_.factors.emplace_back(FactorConfig{.key = "x", .min = 0, .max = 10, .levels = 6});
    plan_.factors.emplace_back(FactorConfig{.key = "y", .min = 0, .max = 10, .levels = 6});
    plan_.points = DesignPoints({}, plan_.factors, {});
    plan_.metrics = {"m", "detected"};
    for (std::size_t i = 0; i < plan_.points.size(); ++i) {
      const double x = *NumberOf(plan_.points[i][1]), y = *NumberOf(plan_.points[i][2]);
      const double value = (plan_.points[i][0] == "b" ? 2 : 1) * (x + 0.1 * y);
      points_.push_back({.point = static_cast<int>(i),
                         .n_runs = 2,
                         .metrics = {{2, value, std::array{value - 0.01, value + 0.01}},
                                     {2, x + y, std::nullopt}}});
    }
  }

  SweepPlan plan_;
  std::vector<PointSummary> points_;
};

TEST_F(Analysis, FindsTheLargestValueWithinTheLimit) {
  const SweepAnalysis analysis = AnalyseSweep(plan_, points_);
  ASSERT_EQ(analysis.groups.size(), 2u);
  EXPECT_EQ(analysis.groups[1].name, "b");
  ASSERT_EQ(analysis.groups[0].largest.size(), 6u);
  // x + 0.1 · 10 = 5; twice that for b.
  EXPECT_NEAR(*analysis.groups[0].largest[5].x, 4, 0.02);
  EXPECT_NEAR(*analysis.groups[1].largest[5].x, 1.5, 0.02);
  EXPECT_LT(*analysis.groups[0].largest[5].sure_x, *analysis.groups[0].largest[5].x);
  EXPECT_FALSE(analysis.groups[0].largest[5].is_end);
}

// Var of w·(x + y/10), w = 1 or 2: x and y uniform on [0, 10], E = 5.5: first order
// x: (1.5)² · 100/12 = 18.75, y: 0.1875, w: 0.25 · 5.5² = 7.5625; in all 2.5 · (100/12)(1.01)
// + 7.5625.
TEST_F(Analysis, IndicesAreThoseOfTheResponse) {
  const SweepAnalysis analysis = AnalyseSweep(plan_, points_);
  const double variance = 2.5 * 100 / 12 * 1.01 + 7.5625;
  EXPECT_THAT(analysis.keys, ElementsAre("w", "x", "y"));
  EXPECT_NEAR(analysis.indices.first[0], 7.5625 / variance, 0.01);
  EXPECT_NEAR(analysis.indices.first[1], 18.75 / variance, 0.01);
  EXPECT_NEAR(analysis.indices.first[2], 0.1875 / variance, 0.01);
  EXPECT_NEAR(analysis.indices.total[1], 2.5 * 100 / 12 / variance, 0.01);
}

TEST_F(Analysis, EffectsAreSortedBySize) {
  const SweepAnalysis analysis = AnalyseSweep(plan_, points_);
  ASSERT_EQ(analysis.effects.size(), 3u);
  EXPECT_EQ(analysis.effects[0].key, "x");
  EXPECT_EQ(analysis.effects[1].key, "w");
  // The middle of two words is the second, b: 2 · (9.5 + 0.5) and 2 · (0.5 + 0.5).
  EXPECT_NEAR(analysis.effects[0].at_high, 20, 0.05);
  EXPECT_NEAR(analysis.effects[0].at_low, 2, 0.05);
}

TEST_F(Analysis, FrontKnowsThatMoreDetectionsAreBetter) {
  const SweepAnalysis analysis = AnalyseSweep(plan_, points_);
  EXPECT_EQ(analysis.all.size(), 72u);
  EXPECT_EQ(analysis.front.front().a, 0) << "no error";
  EXPECT_EQ(analysis.front.back().b, 20) << "all detected";
  EXPECT_THAT(AnalysisJson(plan_, analysis).dump(), HasSubstr("\"pareto\""));
}

TEST_F(Analysis, IsDrawnAndReported) {
  plan_.config.description = "a < b";
  const SweepAnalysis analysis = AnalyseSweep(plan_, points_);
  const std::vector<Figure> figures = SweepFigures(plan_, analysis);
  std::vector<std::string> names;
  for (const Figure& figure : figures) {
    names.push_back(figure.name);
    EXPECT_THAT(figure.svg, testing::StartsWith("<svg xmlns")) << figure.name;
  }
  EXPECT_THAT(names, ElementsAre("map_0", "map_1", "lines_0", "lines_1", "tornado", "sobol_indices",
                                 "pareto"));
  const std::string report = SweepReport(plan_, points_, {}, analysis, figures);
  EXPECT_THAT(report, HasSubstr("a &lt; b"));
  EXPECT_THAT(report, HasSubstr("Largest x up to which m stays at most 5"));
  EXPECT_THAT(report, testing::Not(HasSubstr("http://www.w3.org/1999/xlink")));
  for (const char* remote : {"src=\"http", "href=\"http", "@import", "url("}) {
    EXPECT_THAT(report, testing::Not(HasSubstr(remote))) << "needs no network";
  }
}

// One factor at a time: 11 points have x = 2, only those that differ from the base in x are its
// line.
TEST_F(Analysis, ALineHasTheOtherFactorsAtTheirUsualValue) {
  plan_.factors.clear();
  for (const char* key : {"x", "y", "z"}) {
    plan_.factors.emplace_back(FactorConfig{.key = key, .min = 0, .max = 10, .levels = 6});
  }
  plan_.points = DesignPoints({.type = DesignType::kOneAtATime}, plan_.factors, {"2", "2", "2"});
  ASSERT_EQ(plan_.points.size(), 16u);
  points_.clear();
  for (int i = 0; i < 16; ++i) {
    points_.push_back({.point = i, .n_runs = 1, .metrics = {{1, i, {}}, {1, 1, {}}}});
  }
  plan_.config.design.type = DesignType::kOneAtATime;
  const SweepAnalysis analysis = AnalyseSweep(plan_, points_);
  const std::vector<Figure> figures = SweepFigures(plan_, analysis);
  const auto lines = std::find_if(figures.begin(), figures.end(),
                                  [](const Figure& figure) { return figure.name == "lines_0"; });
  ASSERT_NE(lines, figures.end());
  int n_marks = 0;
  for (std::size_t at = 0; (at = lines->svg.find("r=\"3.2\"", at)) != std::string::npos; ++at) {
    ++n_marks;
  }
  EXPECT_EQ(n_marks, 6 + 1) << "six values of x, and the legend's mark";
  EXPECT_THAT(lines->svg, HasSubstr("y = 2"));
  // What no point says is not drawn. x = 0, 4, 6, 8, 10 are points 1 to 5, y 6 to 10, z 11 to 15.
  EXPECT_TRUE(std::none_of(figures.begin(), figures.end(), [](const Figure& figure) {
    return figure.name.starts_with("map") || figure.name.starts_with("sobol");
  }));
  ASSERT_EQ(analysis.effects.size(), 3u);
  EXPECT_EQ(analysis.effects[0].key, "x");
  EXPECT_EQ(analysis.effects[0].low, "0");
  EXPECT_EQ(analysis.effects[0].high, "10");
  EXPECT_EQ(analysis.effects[0].at_low, 1);
  EXPECT_EQ(analysis.effects[0].at_high, 5);
}

TEST_F(Analysis, TakesASweepOfOnePoint) {
  plan_.factors.clear();
  plan_.points = {{}};
  points_ = {{.point = 0, .metrics = {{1, 2.0, std::nullopt}, {1, 3.0, std::nullopt}}}};
  const SweepAnalysis analysis = AnalyseSweep(plan_, points_);
  EXPECT_TRUE(analysis.groups.empty());
  EXPECT_TRUE(analysis.indices.first.empty());
}

}  // namespace
}  // namespace windhover
