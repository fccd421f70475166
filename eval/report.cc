#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "common/config/enum_name.h"
#include "common/file/whole_file.h"
#include "eval/evaluation.h"
#include "eval/report_charts.h"
#include "eval/report_flight.h"
#include "eval/report_frames.h"
#include "eval/report_parts.h"
#include "eval/report_view.h"
#include "eval/text_file.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

std::string Number(const std::optional<double>& number, const char* format = "{:.4g}") {
  if (!number || !std::isfinite(*number)) return "–";
  return fmt::format(fmt::runtime(format), *number);
}

std::string Banner(const Evaluation& evaluation) {
  const RunRecord& run = evaluation.run;
  const char* words = evaluation.verdict == "pass"   ? "PASS"
                      : evaluation.verdict == "fail" ? "FAIL"
                                                     : "INVALID";
  std::string html = fmt::format("<header class=\"{}\"><h1>{}</h1><p>{}</p>", evaluation.verdict,
                                 words, XmlEscaped(run.scenario.description));
  if (!run.valid) html += fmt::format("<p>{}</p>", XmlEscaped(run.invalid_reason));
  return html + "</header>\n";
}

std::string Tiles(const Evaluation& evaluation) {
  const Scenario& scenario = evaluation.run.scenario;
  const auto n_pass = std::count_if(evaluation.gates.begin(), evaluation.gates.end(),
                                    [](const GateResult& gate) { return gate.pass; });
  std::string html =
      ReportTile(fmt::format("{} / {}", n_pass, evaluation.gates.size()), "gates passed");
  html += ReportTile(fmt::format("{} / {}", evaluation.frames.received, evaluation.frames.sent),
                     "stereo frames answered");
  html += ReportTile(fmt::format("{}", evaluation.targets.frames.size()),
                     "targets in view of both cameras");
  html += ReportTile(fmt::format("{}", evaluation.targets.false_detections), "false detections");
  for (const MethodScore& method : evaluation.methods) {
    if (method.method != scenario.estimator.in_loop) continue;
    html += ReportTile(Number(method.all.abs_rel_all, "{:.3f}"),
                       "error of " + method.method + ", misses included");
  }
  if (evaluation.swarm.min_separation_m) {
    html +=
        ReportTile(Number(evaluation.swarm.min_separation_m, "{:.2f} m"), "smallest separation");
  }
  return "<div class=\"tiles\">\n" + html + "</div>\n";
}

std::string GatesTable(const Evaluation& evaluation) {
  if (evaluation.gates.empty()) return "<p class=\"note\">The scenario expects nothing.</p>\n";
  std::string rows;
  for (const GateResult& gate : evaluation.gates) {
    rows += fmt::format(
        "<tr><td class=\"metric\">{}</td><td>{}</td><td>{}</td><td>{}</td>"
        "<td><span class=\"badge {}\">{}</span></td><td class=\"text\">{}</td></tr>\n",
        XmlEscaped(gate.metric), gate.kind, Number(gate.limit), Number(gate.value),
        gate.pass ? "pass" : "fail", gate.pass ? "pass" : "FAIL", XmlEscaped(gate.message));
  }
  return "<div class=\"wide\"><table><tr><th>metric</th><th>limit on</th><th>limit</th>"
         "<th>value</th><th>result</th><th class=\"text\">why</th></tr>\n" +
         rows + "</table></div>\n";
}

std::string WithInterval(const ErrorMetrics& metrics, const std::string& name,
                         const std::optional<double>& value) {
  const auto interval = metrics.ci95.find(name);
  if (interval == metrics.ci95.end()) return "<td>" + Number(value) + "</td>";
  return fmt::format("<td>{}<small>{:.2g} … {:.2g}</small></td>", Number(value, "{:.3g}"),
                     interval->second[0], interval->second[1]);
}

std::string MethodsTable(const Evaluation& evaluation) {
  std::string rows;
  for (const MethodScore& method : evaluation.methods) {
    const ErrorMetrics& all = method.all;
    rows += fmt::format("<tr><td>{}</td><td>{} / {}</td>", XmlEscaped(method.method), all.detected,
                        all.n);
    rows += WithInterval(all, "abs_rel_all", all.abs_rel_all) +
            WithInterval(all, "abs_rel", all.abs_rel) + WithInterval(all, "sq_rel", all.sq_rel) +
            WithInterval(all, "bias_m", all.bias_m);
    for (const auto& value : {all.rmse_m, all.delta_1_25, all.nees, all.coverage_95,
                              method.lt20.abs_rel, method.gt20.abs_rel, method.shared.abs_rel}) {
      rows += "<td>" + Number(value, "{:.3g}") + "</td>";
    }
    rows += "</tr>\n";
  }
  return "<div class=\"wide\"><table><tr><th>method</th><th>estimates</th><th>Abs Rel, all</th>"
         "<th>Abs Rel</th><th>Sq Rel</th><th>bias, m</th><th>RMSE</th><th>δ &lt; 1.25</th>"
         "<th>NEES</th><th>within 95 %</th><th>&lt; 20 m</th><th>≥ 20 "
         "m</th><th>shared</th></tr>\n" +
         rows +
         "</table></div>\n<p class=\"note\">“Abs Rel, all” counts a frame without an estimate as "
         "an error of 1. Small print: 95 % intervals from resampled blocks of at least 2 s. "
         "“Shared”: Abs Rel over the frames that every method answers.</p>\n";
}

std::string SeenHtml(const Evaluation& evaluation, const std::filesystem::path& frames_dir) {
  const std::string seen = ObserverView(evaluation.run) + FramesHtml(evaluation, frames_dir);
  return seen.empty() ? "" : "<div class=\"frames\">\n" + seen + "</div>\n";
}

std::string SwarmTable(const SwarmMetrics& swarm) {
  if (!swarm.min_separation_m) return "";
  std::string html = ReportTile(Number(swarm.min_separation_m, "{:.2f} m"), "smallest separation");
  html += ReportTile(fmt::format("{}", *swarm.collisions), "collisions");
  html += ReportTile(fmt::format("{}", *swarm.near_misses), "near misses");
  html += ReportTile(Number(swarm.order, "{:.2f}"), "order of headings");
  html += ReportTile(Number(swarm.connectivity, "{:.2f}"), "connectivity by sight");
  if (swarm.false_brakes) html += ReportTile(Number(swarm.false_brakes, "{:.3f}"), "false brakes");
  if (swarm.missed_brakes)
    html += ReportTile(Number(swarm.missed_brakes, "{:.3f}"), "missed brakes");
  return "<div class=\"tiles\">\n" + html + "</div>\n";
}

/// Nested objects and numbers as rows "a.b | value".
std::string JsonRows(const Json& json, const std::string& path) {
  if (!json.is_object()) {
    const std::string value = json.is_number_float() ? Number(json.get<double>())
                              : json.is_string()     ? json.get<std::string>()
                                                     : json.dump();
    return fmt::format("<dt>{}</dt><dd>{}</dd>\n", XmlEscaped(path), XmlEscaped(value));
  }
  std::string rows;
  for (const auto& [key, value] : json.items()) {
    rows += JsonRows(value, path.empty() ? key : path + " · " + key);
  }
  return rows;
}

std::string JsonList(const Json& json) {
  if (!json.is_object() || json.empty()) return "";
  return "<dl>\n" + JsonRows(json, "") + "</dl>\n";
}

std::string TimingHtml(Json timing) {
  if (!timing.is_object() || timing.empty()) return "";
  std::string rows;
  const Json stages_of = timing.value("stages", Json::object());
  for (const auto& [process, stages] : stages_of.items()) {
    for (const Json& stage : stages) {
      if (!stage.is_object()) continue;
      const double n = stage.value("n", 0.0);
      rows += fmt::format("<tr><td>{}</td><td>{}</td><td>{:.0f}</td><td>{}</td><td>{}</td></tr>\n",
                          XmlEscaped(process), XmlEscaped(stage.value("stage", "")), n,
                          Number(stage.value("wall_ms", 0.0) / n),
                          Number(stage.value("cpu_ms", 0.0) / n));
    }
  }
  timing.erase("stages");
  return JsonList(timing) +
         "<div class=\"wide\"><table><tr><th>process</th><th>stage</th><th>times</th><th>wall, "
         "ms each</th><th>CPU, ms each</th></tr>\n" +
         rows + "</table></div>\n";
}

std::string ScenarioList(const Evaluation& evaluation) {
  const Scenario& scenario = evaluation.run.scenario;
  const CalibratedRig& rig = scenario.rig.calibrated;
  const Json facts = {
      {"observe", NameOf(scenario.observe)},
      {"aircraft", scenario.aircraft.size()},
      {"environment", NameOf(scenario.environment.type)},
      {"duration", fmt::format("{:g} s at {:g} Hz", scenario.duration_s, scenario.frame_rate_hz)},
      {"rig",
       fmt::format("{:g} mm baseline, {:g} mm lenses ({:.0f} px), {} x {} px", rig.baseline_m * 1e3,
                   rig.focal_mm, rig.FocalPx(), rig.image[0], rig.image[1])},
      {"misalignment",
       fmt::format("{:g} px, yaw {:g}°, pitch {:g}°, roll {:g}°",
                   scenario.rig.misalignment.offset_px, scenario.rig.misalignment.yaw_deg,
                   scenario.rig.misalignment.pitch_deg, scenario.rig.misalignment.roll_deg)},
      {"reference", NameOf(scenario.score.reference)},
      {"method in the loop", scenario.estimator.in_loop},
      {"disparity offset of this flight",
       Number(evaluation.disparity_offset_px, "{:.2f} px (measured minus true)")}};
  return JsonList(facts);
}

std::string Provenance(const Evaluation& evaluation) {
  Json facts = {{"version", evaluation.run.version}, {"seed", evaluation.run.scenario.random_seed}};
  if (evaluation.manifest.is_object()) facts.update(evaluation.manifest);
  return JsonList(facts) + "<details><summary>score.json</summary><pre>" +
         XmlEscaped(evaluation.score.dump(2)) + "</pre></details>\n";
}

}  // namespace

void WriteReport(const Evaluation& evaluation, const std::filesystem::path& dir) {
  const std::string title = XmlEscaped(evaluation.run.scenario.description);
  std::string html = Banner(evaluation) + Tiles(evaluation);
  html += ReportSection("Gates", GatesTable(evaluation));
  html += ReportSection("Methods", MethodsTable(evaluation));
  html += ReportSection("Error by distance", ErrorByDistanceChart(evaluation));
  html += ReportSection("Distance over time", RangeOverTimeCharts(evaluation));
  html += ReportSection("What was seen", SeenHtml(evaluation, dir / "frames"));
  html += ReportSection("Swarm", SwarmTable(evaluation.swarm) + SeparationChart(evaluation.run));
  html += ReportSection("Flight", FlightViews(evaluation.run));
  html += ReportSection("Scenario", ScenarioList(evaluation));
  html += ReportSection("Timing (wall clock)", TimingHtml(evaluation.timing));
  html += ReportSection("Provenance", Provenance(evaluation));
  ReplaceFile(dir / "report.html", ReportPage(evaluation.verdict + ": " + title, html));
}

}  // namespace windhover
