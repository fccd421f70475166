#include "eval/svg_chart.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "eval/text_file.h"

namespace windhover {
namespace {

constexpr double kWidth = 860, kHeight = 340;
constexpr double kLeft = 64, kRight = 16, kBottom = 48;
constexpr double kLegendTop = 22, kLegendRow = 18;
constexpr int kLooks = 6;

// What of the report's style a chart in a file of its own needs, in light colours.
constexpr const char* kFileStyle = R"css(<style>
svg { background: #f5f7fa; } text { fill: #5b6776; font: 12.5px "DejaVu Sans", sans-serif; }
.grid { stroke: #d9dfe7; stroke-width: 1; }
.line { fill: none; stroke-width: 2; stroke: currentColor; }
.mark { fill: currentColor; stroke: currentColor; stroke-width: 1.4; }
.mark circle, .mark rect, .mark path { stroke: none; }
.s0 { color: #0072b2; } .s1 { color: #d55e00; } .s2 { color: #009e73; }
.s3 { color: #aa4499; } .s4 { color: #b8860b; } .s5 { color: #3a8fc2; }
.line.s1 { stroke-dasharray: 7 4; } .line.s2 { stroke-dasharray: 2 4; }
.line.s3 { stroke-dasharray: 10 4 2 4; } .line.s4 { stroke-dasharray: 14 5; }
.truth { color: #1b2430; } .line.truth { stroke-width: 2.4; }
</style>
)css";

/// From data to the drawing's coordinates. Both axes begin at 0.
struct Axes {
  double x_min, x_max, y_max;
  double top;  ///< Of the plot: below the legend.

  double X(double x) const {
    return kLeft + (x - x_min) / (x_max - x_min) * (kWidth - kLeft - kRight);
  }
  double Y(double y) const { return kHeight - kBottom - y / y_max * (kHeight - top - kBottom); }
};

std::string ClassOf(const ChartSeries& series) {
  return series.look < 0 ? "truth" : fmt::format("s{}", series.look % kLooks);
}

/// Where each entry of the legend begins: as many rows as they need.
std::vector<std::array<double, 2>> LegendPlaces(const Chart& chart) {
  std::vector<std::array<double, 2>> places;
  double x = kLeft, y = kLegendTop;
  for (const ChartSeries& series : chart.series) {
    const double width =
        series.name.empty() ? 0 : 28 + 7.5 * static_cast<double>(series.name.size()) + 24;
    if (x > kLeft && x + width > kWidth - kRight) {
      x = kLeft;
      y += kLegendRow;
    }
    places.push_back({x, y});
    x += width;
  }
  return places;
}

Axes FitAxes(const Chart& chart) {
  const auto places = LegendPlaces(chart);
  Axes axes{0, 0, chart.y_max, kLegendRow + (places.empty() ? kLegendTop : places.back()[1])};
  for (const ChartSeries& series : chart.series) {
    for (const ChartPoint& p : series.points) {
      axes.x_max = std::max(axes.x_max, p.x);
      if (chart.y_max == 0) axes.y_max = std::max({axes.y_max, p.y, p.high});
    }
  }
  if (axes.x_max <= 0) axes.x_max = 1;
  axes.x_max *= 1.02;
  if (axes.y_max <= 0) axes.y_max = 1;
  if (chart.y_max == 0) axes.y_max *= 1.05;
  return axes;
}

std::string DrawAxes(const Chart& chart, const Axes& axes) {
  std::string svg;
  for (const double x : NiceTicks(axes.x_max)) {
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\"/>"
        "<text x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4:g}</text>\n",
        axes.X(x), axes.top, kHeight - kBottom, kHeight - kBottom + 16, x);
  }
  for (const double y : NiceTicks(axes.y_max)) {
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>"
        "<text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5:g}</text>\n",
        kLeft, kWidth - kRight, axes.Y(y), kLeft - 8, axes.Y(y) + 4, y);
  }
  svg += fmt::format("<text x=\"{:.0f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                     (kLeft + kWidth - kRight) / 2, kHeight - 10, XmlEscaped(chart.x_label));
  svg += fmt::format(
      "<text transform=\"translate(16,{:.0f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      (axes.top + kHeight - kBottom) / 2, XmlEscaped(chart.y_label));
  return svg;
}

std::string Marker(int look, double x, double y) {
  switch (look % kLooks) {
    case 0:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.2\"/>", x, y);
    case 1:
      return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"5.6\" height=\"5.6\"/>", x - 2.8,
                         y - 2.8);
    case 2:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l3.6 6.4h-7.2z\"/>", x, y - 3.8);
    case 3:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l4 4l-4 4l-4 -4z\"/>", x, y - 4);
    case 4:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l3.6 -6.4h-7.2z\"/>", x, y + 3.8);
    default:
      return fmt::format("<path d=\"M{0:.1f} {1:.1f}h8v2h-8z M{2:.1f} {3:.1f}v8h2v-8z\"/>", x - 4,
                         y - 1, x - 1, y - 4);
  }
}

bool IsInside(const Axes& axes, const ChartPoint& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && p.y >= 0 && p.y <= axes.y_max;
}

std::string DrawLine(const ChartSeries& series, const Axes& axes) {
  std::string path;
  bool pen_down = false;
  for (const ChartPoint& p : series.points) {
    if (!IsInside(axes, p)) {
      pen_down = false;
      continue;
    }
    path += fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", axes.X(p.x), axes.Y(p.y));
    pen_down = true;
  }
  return fmt::format("<path class=\"line {}\" d=\"{}\"/>\n", ClassOf(series), path);
}

std::string DrawPoints(const ChartSeries& series, const Axes& axes) {
  std::string svg = fmt::format("<g class=\"mark {}\">", ClassOf(series));
  for (const ChartPoint& p : series.points) {
    if (!IsInside(axes, p)) continue;
    if (p.high > p.low) {
      svg += fmt::format("<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/>",
                         axes.X(p.x), axes.Y(std::clamp(p.low, 0.0, axes.y_max)),
                         axes.Y(std::clamp(p.high, 0.0, axes.y_max)));
    }
    svg += Marker(series.look, axes.X(p.x), axes.Y(p.y));
  }
  return svg + "</g>\n";
}

std::string DrawLegend(const Chart& chart) {
  std::string svg;
  const auto places = LegendPlaces(chart);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const ChartSeries& series = chart.series[i];
    const auto& [x, y] = places[i];
    if (series.name.empty()) continue;
    if (series.style != ChartSeries::Style::kPoints) {
      svg += fmt::format("<path class=\"line {}\" d=\"M{} {}h22\"/>", ClassOf(series), x, y);
    }
    if (series.style != ChartSeries::Style::kLine) {
      svg += fmt::format("<g class=\"mark {}\">{}</g>", ClassOf(series),
                         Marker(series.look, x + 11, y));
    }
    svg +=
        fmt::format("<text x=\"{}\" y=\"{}\">{}</text>\n", x + 28, y + 4, XmlEscaped(series.name));
  }
  return svg;
}

std::string DrawClippedNote(const Chart& chart, const Axes& axes) {
  int n_clipped = 0;
  for (const ChartSeries& series : chart.series) {
    n_clipped += static_cast<int>(std::count_if(series.points.begin(), series.points.end(),
                                                [&](auto& p) { return p.y > axes.y_max; }));
  }
  if (n_clipped == 0) return "";
  return fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{} points lie above</text>\n",
                     kWidth - kRight, axes.top - 6, n_clipped);
}

}  // namespace

std::vector<double> NiceTicks(double max) {
  if (!(max > 0) || !std::isfinite(max)) return {0};
  const double power = std::pow(10, std::floor(std::log10(max / 5)));
  double step = power;
  for (const double factor : {2.0, 5.0, 10.0}) {
    if (max / step > 7) step = factor * power;
  }
  std::vector<double> ticks;
  for (int k = 0; k * step <= max * (1 + 1e-9); ++k) ticks.push_back(k * step);
  return ticks;
}

namespace {

std::string DrawPlot(const Chart& chart) {
  const Axes axes = FitAxes(chart);
  std::string svg = DrawAxes(chart, axes);
  for (const ChartSeries& series : chart.series) {
    if (series.style != ChartSeries::Style::kPoints) svg += DrawLine(series, axes);
    if (series.style != ChartSeries::Style::kLine) svg += DrawPoints(series, axes);
  }
  return svg + DrawLegend(chart) + DrawClippedNote(chart, axes);
}

}  // namespace

std::string ChartSvg(const Chart& chart) {
  return fmt::format(
             "<figure><figcaption>{0}</figcaption>"
             "<svg class=\"chart\" viewBox=\"0 0 {1} {2}\" role=\"img\" aria-label=\"{0}\">\n",
             XmlEscaped(chart.title), kWidth, kHeight) +
         DrawPlot(chart) + "</svg></figure>\n";
}

std::string ChartFileSvg(const Chart& chart) {
  constexpr double kTitle = 26;
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{1}\" height=\"{2}\" "
             "viewBox=\"0 {3} {1} {2}\" role=\"img\">\n<title>{0}</title>\n",
             XmlEscaped(chart.title), kWidth, kHeight + kTitle, -kTitle) +
         kFileStyle +
         fmt::format(
             "<text x=\"{}\" y=\"-6\" style=\"font-size: 15px; font-weight: bold\">{}"
             "</text>\n",
             kLeft, XmlEscaped(chart.title)) +
         DrawPlot(chart) + "</svg>\n";
}

}  // namespace windhover
