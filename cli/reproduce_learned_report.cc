#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "cli/reproduce_learned.h"
#include "eval/svg_chart.h"
#include "eval/text_file.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kMethods[] = {"baseline", "offset1", "pcm"};

struct Column {
  const char *key, *title;
};
constexpr Column kColumns[] = {{"pretrained_pretrain", "pcm, pre-trained on pretrain"},
                               {"pretrained_uavde_12mm", "pcm, pre-trained on uavde_12mm"},
                               {"scratch", "pcm from scratch"},
                               {"offset1", "one offset"},
                               {"gain_pretrain", "gain of pretrain"},
                               {"gain_uavde_12mm", "gain of uavde_12mm"}};
constexpr int kErrors = 4;  ///< Columns that are no gains.

double Mean(const Json& cell) { return cell["mean"].get<double>(); }

std::array<double, 2> Interval(const Json& cell) {
  return cell.contains("ci95") ? cell["ci95"].get<std::array<double, 2>>()
                               : std::array<double, 2>{0, 0};
}

std::string CurveSvgOf(const Json& table) {
  Chart chart{.title = "Test Abs Rel behind the new rig",
              .x_label = "tuples of the new rig",
              .y_label = "Abs Rel",
              .series = {},
              .y_max = 0.3};
  for (int i = 0; i < kErrors; ++i) {
    ChartSeries series{.name = kColumns[i].title,
                       .style = ChartSeries::Style::kLineWithPoints,
                       .look = i,
                       .points = {}};
    for (const Json& row : table["rows"]) {
      const auto [low, high] = Interval(row[kColumns[i].key]);
      series.points.push_back(
          {row["n_tuples"].get<double>(), Mean(row[kColumns[i].key]), std::max(0.0, low), high});
    }
    chart.series.push_back(std::move(series));
  }
  return ChartSvg(chart);
}

}  // namespace

std::string LearnedAuditsText(const Json& audits) {
  std::string text = "\nwhat a correction learned, test Abs Rel\n" + fmt::format("{:<28}", "");
  for (const char* method : kMethods) text += fmt::format(" {:>8}", method);
  for (const Json& found : audits["learned"]) {
    text += fmt::format("\n{:<28}", found["question"].get<std::string>());
    for (const char* method : kMethods)
      text += fmt::format(" {:8.3f}", found[method].get<double>());
    text += "  " + found["verdict"].get<std::string>();
  }
  return text + "\n";
}

std::string LearnedAuditsHtml(const Json& audits) {
  std::string html =
      "<h3>What a correction learned</h3><p class=\"note\">One stage of pcm, trained on data set 1 "
      "of uavde_12mm; test Abs Rel. offset1 is the median offset of the training flights.</p>\n"
      "<div class=\"wide\"><table><tr><th></th><th>baseline</th><th>offset1</th><th>pcm</th>"
      "<th>verdict</th></tr>\n";
  for (const Json& found : audits["learned"]) {
    html += fmt::format("<tr><td class=\"text\">{}</td>",
                        XmlEscaped(found["question"].get<std::string>()));
    for (const char* method : kMethods) {
      html += fmt::format("<td>{:.3f}</td>", found[method].get<double>());
    }
    html += fmt::format("<td class=\"text\">{}</td></tr>\n",
                        XmlEscaped(found["verdict"].get<std::string>()));
  }
  return html + "</table></div>\n";
}

std::string PretrainingText(const Json& table) {
  std::string text = fmt::format("{:<12}", "");
  for (const Column& column : kColumns) text += fmt::format(" {:>30}", column.title);
  for (const Json& row : table["rows"]) {
    text += fmt::format("\n{:<12}", row["method"].get<std::string>());
    for (const Column& column : kColumns) {
      const Json& cell = row[column.key];
      const auto [low, high] = Interval(cell);
      const std::string interval =
          cell.contains("ci95") ? fmt::format(" ({:.3f} to {:.3f})", low, high) : "";
      text += fmt::format(" {:>30}", fmt::format("{:.3f}{}", Mean(cell), interval));
    }
  }
  return text + "\n";
}

std::string PretrainingHtml(const Json& table) {
  std::string html = "<p class=\"note\">The new rig: uavde_12mm with";
  for (const Json& set : table["unseen"]) {
    html += " <code>" + XmlEscaped(set.get<std::string>()) + "</code>";
  }
  html += ". A gain is the error from scratch less the pre-trained one.</p>\n";
  html += "<div class=\"wide\"><table><tr><th></th>";
  for (const Column& column : kColumns) {
    html += fmt::format("<th>{}</th>", XmlEscaped(column.title));
  }
  html += "</tr>\n";
  for (const Json& row : table["rows"]) {
    html +=
        fmt::format("<tr><td class=\"text\">{}</td>", XmlEscaped(row["method"].get<std::string>()));
    for (const Column& column : kColumns) {
      const Json& cell = row[column.key];
      html += fmt::format("<td>{:.3f}", Mean(cell));
      if (cell.contains("verdict")) html += ", " + cell["verdict"].get<std::string>();
      const auto [low, high] = Interval(cell);
      if (cell.contains("ci95")) html += fmt::format("<small>{:.3f} to {:.3f}</small>", low, high);
      html += "</td>";
    }
    html += "</tr>\n";
  }
  return html +
         "</table></div>\n<figure><figcaption>Test Abs Rel by tuples of the new rig"
         "</figcaption>" +
         CurveSvgOf(table) + "</figure>\n";
}

}  // namespace windhover
