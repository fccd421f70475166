#include "sweep/sweep_report.h"

#include <algorithm>

#include <fmt/format.h>

#include "eval/report_parts.h"
#include "eval/text_file.h"
#include "sweep/explorer.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostGates = 50;

std::string Table(const std::string& rows) {
  return "<div class=\"wide\"><table>" + rows + "</table></div>\n";
}

std::string Number(const std::optional<double>& number) {
  return number ? fmt::format("{:.4g}", *number) : "–";
}

std::string Banner(const SweepPlan& plan, const std::vector<PointSummary>& points,
                   const std::vector<GateResult>& gates) {
  int n_runs = 0, n_invalid = 0;
  for (const PointSummary& point : points) {
    n_runs += point.n_runs;
    n_invalid += point.n_invalid;
  }
  const auto n_pass = std::count_if(gates.begin(), gates.end(), [](auto& g) { return g.pass; });
  const bool passes = n_pass == static_cast<std::ptrdiff_t>(gates.size());
  const std::string verdict = n_invalid > 0 ? "invalid" : passes ? "pass" : "fail";
  std::string words = verdict;
  for (char& c : words) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return fmt::format("<header class=\"{}\"><h1>{}</h1><p>{}</p></header>\n", verdict, words,
                     XmlEscaped(plan.config.description)) +
         "<div class=\"tiles\">\n" + ReportTile(fmt::format("{}", points.size()), "points") +
         ReportTile(fmt::format("{}", n_runs), "runs") +
         ReportTile(fmt::format("{}", n_invalid), "of them invalid") +
         ReportTile(fmt::format("{} / {}", n_pass, gates.size()), "gates passed") + "</div>\n";
}

std::string Gates(const std::vector<GateResult>& gates) {
  std::string rows;
  std::size_t n = 0;
  for (const GateResult& gate : gates) {
    if (gate.pass || n++ >= kMostGates) continue;
    rows += fmt::format(
        "<tr><td class=\"text\">{}</td><td><span class=\"badge fail\">FAIL</span></td>"
        "<td class=\"text\">{}</td></tr>\n",
        XmlEscaped(gate.name), XmlEscaped(gate.message));
  }
  if (gates.empty()) return "<p class=\"note\">The sweep expects nothing.</p>\n";
  if (rows.empty()) return "<p>All hold.</p>\n";
  const std::string more =
      n > kMostGates
          ? fmt::format("<p class=\"note\">and {} more, in junit.xml</p>", n - kMostGates)
          : "";
  return Table(rows) + more;
}

std::string Drawn(const std::vector<Figure>& figures, const std::string& prefix) {
  std::string html;
  for (const Figure& figure : figures) {
    if (figure.name.starts_with(prefix))
      html += "<figure class=\"wide\">" + figure.svg + "</figure>\n";
  }
  return html;
}

/// For each y and combination of words, the largest x within the limit.
std::string Largest(const SweepAnalysis& analysis) {
  if (analysis.groups.empty() || analysis.groups.front().largest.empty()) return "";
  const auto& numbers = analysis.response.numbers;
  const bool has_y = numbers.size() > 1;
  std::string rows =
      fmt::format("<tr><th>{}</th>", has_y ? XmlEscaped(numbers[analysis.y].key) : "");
  for (const GroupAnalysis& group : analysis.groups) {
    rows += fmt::format("<th>{}</th>", XmlEscaped(group.name.empty() ? "largest" : group.name));
  }
  rows += "</tr>\n";
  for (std::size_t i = 0; i < analysis.groups.front().largest.size(); ++i) {
    rows += fmt::format("<tr><td>{:.4g}</td>", analysis.groups.front().largest[i].y);
    for (const GroupAnalysis& group : analysis.groups) {
      if (i >= group.largest.size()) continue;
      const LargestValue& one = group.largest[i];
      rows += fmt::format("<td>{}{}<small>{}</small></td>", one.is_end ? "≥ " : "", Number(one.x),
                          Number(one.sure_x));
    }
    rows += "</tr>\n";
  }
  return fmt::format(
             "<p>Largest {} up to which {} stays at most {:g}, by the Gaussian process; small "
             "print: "
             "of its mean + 1.96 sigma. –: not even the smallest.</p>\n",
             XmlEscaped(numbers[analysis.x].key), XmlEscaped(analysis.response.metric),
             *analysis.limit) +
         Table(rows);
}

std::string Surfaces(const SweepAnalysis& analysis) {
  std::string rows;
  for (const GroupAnalysis& group : analysis.groups) {
    if (!group.surface) continue;
    std::string terms;
    for (const auto& [name, coefficient] : group.quadratic.terms) {
      terms += fmt::format("{}{:+.3g} {}", terms.empty() ? "" : " ", coefficient,
                           name == "1" ? "" : name);
    }
    const auto& quadratic = group.quadratic;
    rows += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"text\">{}</td></tr>\n",
        XmlEscaped(group.name), Number(group.surface->leave_one_out_rmse()),
        quadratic.terms.empty() ? "–" : Number(quadratic.leave_one_out_rmse),
        quadratic.terms.empty() ? "–" : Number(quadratic.r_squared), XmlEscaped(terms));
  }
  if (rows.empty()) return "";
  return "<p>Error of each point predicted from the others, of a Gaussian process and of a "
         "quadratic in coordinates from −1 to 1.</p>\n" +
         Table(
             "<tr><th></th><th>Gaussian process</th><th>quadratic</th><th>R²</th>"
             "<th class=\"text\">quadratic</th></tr>\n" +
             rows);
}

std::string Explorer(const SweepPlan& plan, const std::vector<PointSummary>& points) {
  if (plan.factors.empty()) return "";
  Json factors = Json::array(), values = Json::array(), means = Json::array();
  for (const Factor& factor : plan.factors) factors.push_back(factor.key());
  for (const PointSummary& point : points) {
    values.push_back(plan.points[static_cast<std::size_t>(point.point)]);
    Json row = Json::array();
    for (const MetricSummary& metric : point.metrics) {
      const bool has_ends = metric.ci95.has_value();
      row.push_back({metric.mean ? Json(*metric.mean) : Json(nullptr),
                     has_ends ? Json((*metric.ci95)[0]) : Json(nullptr),
                     has_ends ? Json((*metric.ci95)[1]) : Json(nullptr)});
    }
    means.push_back(row);
  }
  std::string json = Json{
      {"factors", factors},
      {"metrics", plan.metrics},
      {"points", values},
      {"means", means}}.dump();
  for (std::size_t at = 0; (at = json.find("</", at)) != std::string::npos;)
    json.insert(++at, "\\");
  return "<script type=\"application/json\" id=\"sweep-data\">" + json + "</script>" + kExplorer;
}

}  // namespace

std::string SweepReport(const SweepPlan& plan, const std::vector<PointSummary>& points,
                        const std::vector<GateResult>& gates, const SweepAnalysis& analysis,
                        const std::vector<Figure>& figures) {
  std::string html = Banner(plan, points, gates);
  html += ReportSection("Gates", Gates(gates));
  html += ReportSection("Map", Drawn(figures, "map_"));
  html += ReportSection("Within the limit", Largest(analysis));
  html += ReportSection("Lines", Drawn(figures, "lines_"));
  html += ReportSection("What matters", Drawn(figures, "tornado") + Drawn(figures, "sobol"));
  html += ReportSection("Trade", Drawn(figures, "pareto"));
  html += ReportSection("Surfaces", Surfaces(analysis));
  html += ReportSection("Explore", Explorer(plan, points));
  html +=
      "<p class=\"note\">table.csv has every run, points.csv every point, analysis.json these "
      "numbers; figures/ the drawings.</p>\n";
  return ReportPage("sweep: " + XmlEscaped(plan.config.description), html);
}

}  // namespace windhover
