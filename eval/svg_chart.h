#pragma once

#include <string>
#include <vector>

namespace windhover {

struct ChartPoint {
  double x, y;
  double low = 0, high = 0;  ///< Ends of the error bar; equal: none.
};

/// One set of points or one line. Series differ by colour and by marker or dash, so that no one
/// needs to tell colours apart.
struct ChartSeries {
  enum class Style { kLine, kPoints, kLineWithPoints };
  std::string name;  ///< Empty: not in the legend.
  Style style = Style::kLine;
  int look = 0;  ///< Colour and marker; series of one method look alike in every chart. -1: truth.
  std::vector<ChartPoint> points;
};

struct Chart {
  std::string title, x_label, y_label;
  std::vector<ChartSeries> series;
  double y_max = 0;  ///< Points above are left out and counted in a note; 0: fits all.
};

/// The chart as an inline <svg> with a legend; colours are CSS variables of the report's style.
std::string ChartSvg(const Chart& chart);

/// The chart as the content of an .svg file that needs nothing else, in light colours.
std::string ChartFileSvg(const Chart& chart);

/// Round numbers that divide [0, max], a handful of them.
std::vector<double> NiceTicks(double max);

}  // namespace windhover
