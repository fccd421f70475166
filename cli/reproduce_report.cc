#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "cli/reproduce_learned.h"
#include "eval/report_style.h"
#include "eval/svg_chart.h"
#include "eval/text_file.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

struct Column {
  const char *split, *key, *title;
};
constexpr Column kColumns[] = {
    {"val", "abs_rel", "val Abs Rel"},   {"val", "sq_rel", "val Sq Rel"},
    {"val", "lt20", "val < 20 m"},       {"val", "gt20", "val > 20 m"},
    {"test", "abs_rel", "test Abs Rel"}, {"test", "sq_rel", "test Sq Rel"},
    {"test", "lt20", "test < 20 m"},     {"test", "gt20", "test > 20 m"},
    {"test", "ap50", "test AP50"},       {"test", "recall", "test recall"}};

std::string Number(const Json& number) { return fmt::format("{:.3f}", number.get<double>()); }

bool HasPaper(const Json& row, const Column& column) {
  return row["paper"].contains(column.split) && row["paper"][column.split].contains(column.key);
}

bool HasOurs(const Json& row, const Column& column) {
  return row.contains(column.split) && row[column.split].contains(column.key);
}

/// Of the test split, and listed in the table's "also".
bool IsOurOwn(const Json& table, const Column& column) {
  return column.split == std::string("test") && table.contains("also") &&
         std::find(table["also"].begin(), table["also"].end(), column.key) != table["also"].end();
}

/// The columns that the paper has in this table, and those that we have besides; Abs Rel and Sq Rel
/// of the test split where there are none.
std::vector<Column> ColumnsOf(const Json& table) {
  std::vector<Column> columns;
  for (const Column& column : kColumns) {
    const bool is_in_paper = std::any_of(table["rows"].begin(), table["rows"].end(),
                                         [&](const Json& row) { return HasPaper(row, column); });
    if (is_in_paper || IsOurOwn(table, column)) columns.push_back(column);
  }
  if (columns.empty()) columns = {kColumns[4], kColumns[5], kColumns[6], kColumns[7]};
  return columns;
}

/// Is the paper's number outside the interval of ours? Nothing to say without an interval.
bool Differs(const Json& row, const Column& column) {
  if (!HasPaper(row, column) || !HasOurs(row, column)) return false;
  const Json& ours = row[column.split];
  if (!ours.contains("ci95") || !ours["ci95"].contains(column.key)) return false;
  const double paper = row["paper"][column.split][column.key].get<double>();
  const auto [low, high] = ours["ci95"][column.key].get<std::array<double, 2>>();
  return paper < low || paper > high;
}

/// What there is to say of Abs Rel of the test split that is not the paper's.
std::string Remark(const Json& row) {
  if (row.contains("missing")) return row["missing"].get<std::string>();
  const Column& column = kColumns[4];
  if (!Differs(row, column)) return "";
  const double ours = row["test"]["abs_rel"].get<double>();
  const double paper = row["paper"]["test"]["abs_rel"].get<double>();
  std::string text = fmt::format("{:.3f} is {} the paper's {:.3f}.", ours,
                                 ours < paper ? "below" : "above", paper);
  if (row.contains("why")) text += " " + row["why"].get<std::string>();
  return text;
}

std::string Cell(const Json& row, const Column& column) {
  const bool has_ours = HasOurs(row, column), has_paper = HasPaper(row, column);
  if (!has_ours && !has_paper) return "<td></td>";
  std::string text = has_ours ? Number(row[column.split][column.key]) : "–";
  if (has_paper) text += " | " + Number(row["paper"][column.split][column.key]);
  if (has_ours && row[column.split].contains("ci95") &&
      row[column.split]["ci95"].contains(column.key)) {
    const auto [low, high] = row[column.split]["ci95"][column.key].get<std::array<double, 2>>();
    text += fmt::format("<small>{:.3f} to {:.3f}</small>", low, high);
  }
  return fmt::format("<td>{}{}{}</td>", Differs(row, column) ? "<b>" : "", text,
                     Differs(row, column) ? "</b>" : "");
}

std::string ScoresHtml(const Json& table) {
  const std::vector<Column> columns = ColumnsOf(table);
  std::string html = "<div class=\"wide\"><table><tr><th>ours | paper</th>";
  for (const Column& column : columns) {
    html += fmt::format("<th>{}</th>", XmlEscaped(column.title));
  }
  html += "</tr>\n";
  std::string remarks;
  for (const Json& row : table["rows"]) {
    const std::string name = XmlEscaped(row["method"].get<std::string>());
    html += fmt::format("<tr><td class=\"text\">{}</td>", name);
    for (const Column& column : columns) html += Cell(row, column);
    html += "</tr>\n";
    const std::string remark = Remark(row);
    if (!remark.empty()) remarks += fmt::format("<dt>{}</dt><dd>{}</dd>", name, XmlEscaped(remark));
  }
  html += "</table></div>\n";
  if (!remarks.empty()) html += "<dl class=\"note\">" + remarks + "</dl>\n";
  return html;
}

/// Errors and distances over the distance, before and after the corrections.
std::string ChartsHtml(const Json& table) {
  Chart errors{.title = "Error before and after the corrections, test flights",
               .x_label = "distance, m",
               .y_label = "Abs Rel",
               .series = {}};
  Chart ranges{.title = "Distances before and after the corrections, test flights",
               .x_label = "distance, m",
               .y_label = "mean of what the method says, m",
               .series = {}};
  ChartSeries truth{.name = "truth", .look = -1, .points = {{0, 0}, {45, 45}}};
  ranges.series.push_back(truth);
  int look = 0;
  for (const Json& row : table["rows"]) {
    if (!row.contains("by_distance")) continue;
    ChartSeries error{.name = row["method"].get<std::string>(),
                      .style = ChartSeries::Style::kLineWithPoints,
                      .look = look++ % 6,
                      .points = {}};
    ChartSeries range = error;
    for (const Json& bin : row["by_distance"]) {
      const double mean_m = bin["mean_reference_m"].get<double>();
      error.points.push_back({mean_m, bin["abs_rel"].get<double>()});
      range.points.push_back({mean_m, bin["range_m"].get<double>()});
    }
    errors.series.push_back(std::move(error));
    ranges.series.push_back(std::move(range));
  }
  std::string html;
  for (const Chart& chart : {errors, ranges}) {
    html += fmt::format("<figure>{}</figure>\n", ChartSvg(chart));
  }
  return html;
}

std::string ResourcesHtml(const Json& table) {
  constexpr const char* kKeys[] = {"parameters", "flops", "us_per_call", "fps"};
  std::string html = "<div class=\"wide\"><table><tr><th>ours | paper</th>";
  for (const char* key : kKeys) html += fmt::format("<th>{}</th>", key);
  html += "</tr>\n";
  for (const Json& row : table["rows"]) {
    html +=
        fmt::format("<tr><td class=\"text\">{}</td>", XmlEscaped(row["method"].get<std::string>()));
    for (const char* key : kKeys) {
      const auto number = [&](const Json& from) {
        return from.contains(key) ? fmt::format("{:.4g}", from[key].get<double>())
                                  : std::string("–");
      };
      html += fmt::format("<td>{} | {}</td>", number(row), number(row["paper"]));
    }
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

}  // namespace

std::string ReproducedText(const Json& table) {
  std::string text = fmt::format("{}: {}\n", table["table"].get<std::string>(),
                                 table["meaning"].get<std::string>());
  if (table["table"] == "pretraining") return text + PretrainingText(table);
  if (table["table"] == "resources") {
    for (const Json& row : table["rows"]) {
      text += fmt::format("{:<34}", row["method"].get<std::string>());
      for (const char* key : {"parameters", "flops", "us_per_call"}) {
        if (row.contains(key)) text += fmt::format(" {} {:.4g}", key, row[key].get<double>());
      }
      text += "\n";
    }
    return text;
  }
  const std::vector<Column> columns = ColumnsOf(table);
  text += fmt::format("{:<38}", "ours±sd | paper");
  for (const Column& column : columns) text += fmt::format(" {:>20}", column.title);
  for (const Json& row : table["rows"]) {
    text += fmt::format("\n{:<38}", row["method"].get<std::string>());
    for (const Column& column : columns) {
      std::string cell = "–";
      if (HasOurs(row, column)) {
        cell = Number(row[column.split][column.key]);
        if (row[column.split].contains("sd")) {
          cell += "±" + Number(row[column.split]["sd"][column.key]);
        }
      }
      if (HasPaper(row, column)) {
        cell += " | " + Number(row["paper"][column.split][column.key]);
      }
      text += fmt::format(" {:>20}", cell);
    }
  }
  text += "\n";
  return table.contains("learned") ? text + LearnedAuditsText(table) : text;
}

std::string ReproducedPage(const std::vector<Json>& tables) {
  std::string html = fmt::format(
      "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>The paper's tables"
      "</title><style>{}</style></head><body>\n<header class=\"pass\"><h1>The paper's tables</h1>"
      "<p>ours | paper; below, the 95 % interval of ours over flights. Bold: the paper's number "
      "is outside it.</p></header>\n",
      kReportStyle);
  for (const Json& table : tables) {
    const std::string name = table["table"].get<std::string>();
    html += fmt::format("<section><h2>{}</h2><p class=\"note\">{}</p>\n", XmlEscaped(name),
                        XmlEscaped(table["meaning"].get<std::string>()));
    html += name == "resources"     ? ResourcesHtml(table)
            : name == "pretraining" ? PretrainingHtml(table)
                                    : ScoresHtml(table);
    if (table.contains("learned")) html += LearnedAuditsHtml(table);
    if (name == "hard_samples") html += ChartsHtml(table);
    html += "</section>\n";
  }
  return html + "</body></html>\n";
}

}  // namespace windhover
