#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "eval/text_file.h"
#include "sweep/sweep_figures.h"

namespace windhover {
namespace {

constexpr double kWidth = 800, kLeft = 310, kRight = 150, kTop = 44, kRow = 40, kBottom = 40;

/// One bar of a row of horizontal bars.
struct Bar {
  double from, to;
  const char* colour;
};

struct BarRow {
  std::string label, note;
  std::vector<Bar> bars;
};

/// Horizontal bars over one axis, with a line at `centre`.
std::string BarsSvg(const std::string& title, const std::string& x_label,
                    const std::vector<BarRow>& rows, double centre) {
  double low = centre, high = centre;
  for (const BarRow& row : rows) {
    for (const Bar& bar : row.bars) {
      low = std::min({low, bar.from, bar.to});
      high = std::max({high, bar.from, bar.to});
    }
  }
  if (!(high > low)) high = low + 1;
  const double height = kTop + kRow * static_cast<double>(rows.size()) + kBottom;
  const auto x = [&](double v) {
    return kLeft + (v - low) / (high - low) * (kWidth - kLeft - kRight);
  };
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\" role=\"img\">\n<style>text {{ fill: #5b6776; font: 12.5px "
      "\"DejaVu Sans\", sans-serif; }}</style><rect width=\"{0}\" height=\"{1}\" "
      "fill=\"#f5f7fa\"/>\n<text x=\"16\" y=\"22\" style=\"font-weight: bold\">{2}</text>\n",
      kWidth, height, XmlEscaped(title));
  double y = kTop;
  for (const BarRow& row : rows) {
    svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>", kLeft - 8,
                       y + kRow / 2, XmlEscaped(row.label));
    const double bar_height = (kRow - 12) / static_cast<double>(row.bars.size());
    for (std::size_t i = 0; i < row.bars.size(); ++i) {
      const Bar& bar = row.bars[i];
      svg += fmt::format(
          "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>",
          std::min(x(bar.from), x(bar.to)), y + 2 + bar_height * static_cast<double>(i),
          std::max(1.0, std::abs(x(bar.to) - x(bar.from))), bar_height - 2, bar.colour);
    }
    svg += fmt::format("<text x=\"{}\" y=\"{}\">{}</text>\n", kWidth - kRight + 8, y + kRow / 2,
                       XmlEscaped(row.note));
    y += kRow;
  }
  svg +=
      fmt::format("<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" stroke=\"#1b2430\"/>",
                  x(centre), kTop - 4, y);
  for (const double v : {low, high}) {
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{:.3g}</text>", x(v),
                       y + 16, v);
  }
  return svg + fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text></svg>\n",
                           (kLeft + kWidth - kRight) / 2, y + 32, XmlEscaped(x_label));
}

}  // namespace

std::vector<Figure> IndexFigures(const SweepAnalysis& analysis) {
  if (analysis.indices.first.empty()) return {};
  std::vector<BarRow> rows;
  for (std::size_t i = 0; i < analysis.keys.size(); ++i) {
    const double first = analysis.indices.first[i], total = analysis.indices.total[i];
    rows.push_back({analysis.keys[i],
                    fmt::format("{:.2f}, {:.2f}", first, total),
                    {{0, first, "#0072b2"}, {0, total, "#d55e00"}}});
  }
  const std::string title =
      "Share of the variance of " + analysis.response.metric + " (blue: alone, orange: in all)";
  return {{"sobol_indices", title, BarsSvg(title, "Sobol index: first, total", rows, 0)}};
}

std::vector<Figure> TornadoFigures(const SweepAnalysis& analysis) {
  if (analysis.effects.empty()) return {};
  std::vector<BarRow> rows;
  double centre = 0;
  for (const FactorEffect& effect : analysis.effects)
    centre += (effect.at_low + effect.at_high) / 2;
  centre /= static_cast<double>(analysis.effects.size());
  for (const FactorEffect& effect : analysis.effects) {
    const auto shortened = [](const std::string& value) {
      const auto number = NumberOf(value);
      return number ? fmt::format("{:.3g}", *number) : value;
    };
    rows.push_back(
        {fmt::format("{}: {} … {}", effect.key, shortened(effect.low), shortened(effect.high)),
         fmt::format("{:.3g} → {:.3g}", effect.at_low, effect.at_high),
         {{std::min(effect.at_low, effect.at_high), std::max(effect.at_low, effect.at_high),
           effect.at_high > effect.at_low ? "#d55e00" : "#0072b2"}}});
  }
  const std::string title = "What each factor does alone (orange: it rises)";
  return {{"tornado", title, BarsSvg(title, analysis.response.metric, rows, centre)}};
}

}  // namespace windhover
