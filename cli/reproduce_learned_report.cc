#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "cli/reproduce_learned.h"
#include "eval/svg_chart.h"
#include "eval/text_file.h"
#include "learn/audit.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kMethods[] = {"baseline", "offset1", "pcm"};

struct Column {
  const char *key, *title;
};
using Columns = std::array<Column, 6>;
constexpr int kErrors = 4;  ///< Columns that are no gains.
constexpr Columns kPcm = {{{"pretrained_pretrain", "pcm, pre-trained on pretrain"},
                           {"pretrained_uavde_12mm", "pcm, pre-trained on uavde_12mm"},
                           {"scratch", "pcm from scratch"},
                           {"offset1", "one offset"},
                           {"gain_pretrain", "gain of pretrain"},
                           {"gain_uavde_12mm", "gain of uavde_12mm"}}};
constexpr Columns kJoint = {
    {{"joint_mlp_pretrained_pretrain", "joint_mlp, pre-trained on pretrain"},
     {"joint_mlp_pretrained_uavde_12mm", "joint_mlp, on uavde_12mm"},
     {"joint_mlp_scratch", "joint_mlp from scratch"},
     {"offset1", "one offset"},
     {"joint_mlp_gain_pretrain", "gain of pretrain"},
     {"joint_mlp_gain_uavde_12mm", "gain of uavde_12mm"}}};

double Mean(const Json& cell) { return cell["mean"].get<double>(); }

std::array<double, 2> Interval(const Json& cell) {
  return cell.contains("ci95") ? cell["ci95"].get<std::array<double, 2>>()
                               : std::array<double, 2>{0, 0};
}

std::string CurveSvgOf(const Json& table, const Columns& columns) {
  Chart chart{.title = "Test Abs Rel behind the new rig",
              .x_label = "tuples of the new rig",
              .y_label = "Abs Rel",
              .series = {},
              .y_max = 0.3};
  for (int i = 0; i < kErrors; ++i) {
    ChartSeries series{.name = columns[static_cast<std::size_t>(i)].title,
                       .style = ChartSeries::Style::kLineWithPoints,
                       .look = i,
                       .points = {}};
    for (const Json& row : table["rows"]) {
      const auto [low, high] = Interval(row[columns[static_cast<std::size_t>(i)].key]);
      series.points.push_back({row["n_tuples"].get<double>(),
                               Mean(row[columns[static_cast<std::size_t>(i)].key]),
                               std::max(0.0, low), high});
    }
    chart.series.push_back(std::move(series));
  }
  return ChartSvg(chart);
}

/// Table and curve of one learner.
std::string LearnerHtml(const Json& table, const Columns& columns) {
  std::string html = "<div class=\"wide\"><table><tr><th></th>";
  for (const Column& column : columns) {
    html += fmt::format("<th>{}</th>", XmlEscaped(column.title));
  }
  html += "</tr>\n";
  for (const Json& row : table["rows"]) {
    html +=
        fmt::format("<tr><td class=\"text\">{}</td>", XmlEscaped(row["method"].get<std::string>()));
    for (const Column& column : columns) {
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
         CurveSvgOf(table, columns) + "</figure>\n";
}

}  // namespace

std::string LearnedAuditsText(const Json& audits) {
  std::vector<AuditFinding> findings;
  for (const Json& found : audits["learned"]) {
    findings.push_back(
        {found["question"], found["baseline"], found["offset1"], found["pcm"], found["verdict"]});
  }
  return "\nwhat a correction learned, test Abs Rel\n" + AuditText(findings);
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
  std::string text;
  for (const Columns& columns : {kPcm, kJoint}) {
    text += fmt::format("{:<12}", "");
    for (const Column& column : columns) text += fmt::format(" {:>34}", column.title);
    for (const Json& row : table["rows"]) {
      text += fmt::format("\n{:<12}", row["method"].get<std::string>());
      for (const Column& column : columns) {
        const Json& cell = row[column.key];
        const auto [low, high] = Interval(cell);
        const std::string interval =
            cell.contains("ci95") ? fmt::format(" ({:.3f} to {:.3f})", low, high) : "";
        text += fmt::format(" {:>34}", fmt::format("{:.3f}{}", Mean(cell), interval));
      }
    }
    text += "\n";
  }
  return text;
}

std::string PretrainingHtml(const Json& table) {
  std::string html = "<p class=\"note\">The new rig: uavde_12mm with";
  for (const Json& set : table["unseen"]) {
    html += " <code>" + XmlEscaped(set.get<std::string>()) + "</code>";
  }
  html += ". A gain is the error from scratch less the pre-trained one.</p>\n";
  return html + LearnerHtml(table, kPcm) + LearnerHtml(table, kJoint);
}

}  // namespace windhover
