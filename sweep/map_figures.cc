#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "eval/text_file.h"
#include "sweep/sweep_figures.h"

namespace windhover {
namespace {

using Eigen::Index;

constexpr double kWidth = 620, kHeight = 430;
constexpr double kLeft = 70, kTop = 40, kPlotWidth = 430, kPlotHeight = 330, kBarX = 530;

/// Colours of the scale: viridis (S. van der Walt and N. Smith, 2015; CC0), which also colour-blind
/// readers and black-and-white prints order rightly.
constexpr std::array<std::array<double, 3>, 6> kViridis = {
    {{68, 1, 84}, {65, 68, 135}, {42, 120, 142}, {34, 168, 132}, {122, 209, 81}, {253, 231, 37}}};

std::string Colour(double share) {
  const double at = std::clamp(share, 0.0, 1.0) * (kViridis.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), kViridis.size() - 2);
  const double t = at - static_cast<double>(i);
  std::string text = "#";
  for (std::size_t c = 0; c < 3; ++c) {
    text += fmt::format("{:02x}", std::lround((1 - t) * kViridis[i][c] + t * kViridis[i + 1][c]));
  }
  return text;
}

/// Values between which colours go: alike in all maps of a sweep.
struct Scale {
  double low = INFINITY, high = -INFINITY;
  double Share(double value) const { return high > low ? (value - low) / (high - low) : 0.5; }
};

double X(double coded) { return kLeft + coded * kPlotWidth; }
double Y(double coded) { return kTop + (1 - coded) * kPlotHeight; }

std::string Cells(const ResponseMap& map, const Scale& scale) {
  std::string svg = "<g shape-rendering=\"crispEdges\">";
  const Index n_x = map.values.rows(), n_y = map.values.cols();
  const double width = kPlotWidth / static_cast<double>(n_x - 1);
  const double height = kPlotHeight / static_cast<double>(n_y - 1);
  for (Index i = 0; i + 1 < n_x; ++i) {
    for (Index j = 0; j + 1 < n_y; ++j) {
      const double value = map.values.block<2, 2>(i, j).mean();
      svg += fmt::format(
          "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"{}\"/>",
          kLeft + static_cast<double>(i) * width,
          kTop + kPlotHeight - static_cast<double>(j + 1) * height, width + 0.3, height + 0.3,
          Colour(scale.Share(value)));
    }
  }
  return svg + "</g>\n";
}

std::string Contour(const ResponseMap& map, double level) {
  std::string path;
  for (const auto& [x1, y1, x2, y2] : ContourOf(map, level)) {
    path += fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", X(x1), Y(y1), X(x2), Y(y2));
  }
  if (path.empty()) return "";
  return fmt::format(
      "<path d=\"{0}\" fill=\"none\" stroke=\"#000\" stroke-width=\"4.5\"/>"
      "<path d=\"{0}\" fill=\"none\" stroke=\"#fff\" stroke-width=\"2.2\"/>\n",
      path);
}

/// Where runs were flown; pointing at one tells what came out.
std::string Points(const SweepAnalysis& analysis, const ResponseGroup& group, const Scale& scale) {
  const CodedFactor& of_x = analysis.response.numbers[analysis.x];
  const CodedFactor& of_y = analysis.response.numbers[analysis.y];
  std::string svg;
  for (Index i = 0; i < group.x.rows(); ++i) {
    const double x = group.x(i, static_cast<Index>(analysis.x));
    const double y = group.x(i, static_cast<Index>(analysis.y));
    svg += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.4\" fill=\"{}\" stroke=\"#fff\" "
        "stroke-width=\"0.9\"><title>{} = {:.4g}, {} = {:.4g}: {:.4g}</title></circle>\n",
        X(x), Y(y), Colour(scale.Share(group.y[i])), of_x.key, of_x.Decode(x), of_y.key,
        of_y.Decode(y), group.y[i]);
  }
  return svg;
}

std::string AxisLabels(const CodedFactor& of_x, const CodedFactor& of_y) {
  std::string svg;
  for (int k = 0; k <= 4; ++k) {
    const double at = k / 4.0;
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{:.3g}</text>", X(at),
                       kTop + kPlotHeight + 18, of_x.Decode(at));
    svg += fmt::format("<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{:.3g}</text>", kLeft - 8,
                       Y(at) + 4, of_y.Decode(at));
  }
  svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                     kLeft + kPlotWidth / 2, kTop + kPlotHeight + 40, XmlEscaped(of_x.key));
  svg += fmt::format(
      "<text transform=\"translate(16 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      kTop + kPlotHeight / 2, XmlEscaped(of_y.key));
  return svg;
}

std::string ColourBar(const Scale& scale) {
  std::string svg;
  constexpr int kSteps = 60;
  for (int k = 0; k < kSteps; ++k) {
    svg += fmt::format("<rect x=\"{}\" y=\"{:.2f}\" width=\"16\" height=\"{:.2f}\" fill=\"{}\"/>",
                       kBarX, kTop + kPlotHeight * (1 - (k + 1.0) / kSteps),
                       kPlotHeight / kSteps + 0.3, Colour((k + 0.5) / kSteps));
  }
  for (int k = 0; k <= 4; ++k) {
    svg += fmt::format("<text x=\"{}\" y=\"{:.1f}\">{:.3g}</text>", kBarX + 22,
                       kTop + kPlotHeight * (1 - k / 4.0) + 4,
                       scale.low + k / 4.0 * (scale.high - scale.low));
  }
  return svg + "\n";
}

std::string MapSvg(const SweepAnalysis& analysis, std::size_t g, const Scale& scale,
                   const std::string& title) {
  const GroupAnalysis& group = analysis.groups[g];
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\" role=\"img\">\n<style>text {{ fill: #5b6776; font: 12.5px "
      "\"DejaVu Sans\", sans-serif; }}</style><rect width=\"{0}\" height=\"{1}\" "
      "fill=\"#f5f7fa\"/>\n<text x=\"{2}\" y=\"22\" style=\"font-weight: bold\">{3}</text>\n",
      kWidth, kHeight, kLeft, XmlEscaped(title));
  svg += Cells(group.map, scale);
  if (analysis.limit) svg += Contour(group.map, *analysis.limit);
  svg += Points(analysis, analysis.response.groups[g], scale);
  svg += AxisLabels(analysis.response.numbers[analysis.x], analysis.response.numbers[analysis.y]);
  return svg + ColourBar(scale) + "</svg>\n";
}

}  // namespace

std::vector<Figure> MapFigures(const SweepPlan&, const SweepAnalysis& analysis) {
  Scale scale;
  for (const GroupAnalysis& group : analysis.groups) {
    if (group.map.values.size() == 0) continue;
    scale.low = std::min(scale.low, group.map.values.minCoeff());
    scale.high = std::max(scale.high, group.map.values.maxCoeff());
  }
  std::vector<Figure> figures;
  for (std::size_t g = 0; g < analysis.groups.size(); ++g) {
    const GroupAnalysis& group = analysis.groups[g];
    if (group.map.values.size() == 0) continue;
    std::string title = analysis.response.metric;
    if (!group.name.empty()) title += ", " + group.name;
    if (analysis.limit) title += fmt::format("; line: {:g}", *analysis.limit);
    figures.push_back({fmt::format("map_{}", g), title, MapSvg(analysis, g, scale, title)});
  }
  return figures;
}

}  // namespace windhover
