#include "eval/report_charts.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "common/config/enum_name.h"
#include "eval/svg_chart.h"

namespace windhover {
namespace {

constexpr std::size_t kMaxPairs = 4;
constexpr std::size_t kMaxPoints = 400;  // More would not be told apart on the page.

using PairFrames = std::vector<const TargetFrame*>;

/// Every how many-th of so many frames is drawn.
std::size_t StepOf(std::size_t n_frames) {
  return std::max<std::size_t>(1, (n_frames + kMaxPoints - 1) / kMaxPoints);
}

PairFrames Thinned(const PairFrames& frames) {
  PairFrames thinned;
  for (std::size_t i = 0; i < frames.size(); i += StepOf(frames.size())) {
    thinned.push_back(frames[i]);
  }
  return thinned;
}

Chart RangeOverTime(const Evaluation& evaluation, int observer, int target,
                    const PairFrames& all_frames) {
  const std::size_t step = StepOf(all_frames.size());
  const PairFrames frames = Thinned(all_frames);
  const auto& methods = evaluation.run.scenario.estimator.methods;
  Chart chart;
  chart.title = fmt::format("Aircraft {} watches aircraft {}", observer, target);
  chart.x_label = "time, s";
  chart.y_label = "distance, m";
  ChartSeries truth{.name = NameOf(evaluation.run.scenario.score.reference) + " (reference)",
                    .style = ChartSeries::Style::kLine,
                    .look = -1,
                    .points = {}};
  double farthest_m = 0;
  const double longest_gap_s =
      1.5 * static_cast<double>(step) / evaluation.run.scenario.frame_rate_hz;
  for (const TargetFrame* frame : frames) {
    // Where the target was out of view the line is broken.
    const double time_s = SecondsFromUtime(frame->utime);
    if (!truth.points.empty() && time_s - truth.points.back().x > longest_gap_s) {
      truth.points.push_back({time_s, std::numeric_limits<double>::quiet_NaN()});
    }
    truth.points.push_back({SecondsFromUtime(frame->utime), frame->reference_m});
    farthest_m = std::max(farthest_m, frame->reference_m);
  }
  for (std::size_t m = 0; m < methods.size(); ++m) {
    ChartSeries series{.name = methods[m],
                       .style = ChartSeries::Style::kPoints,
                       .look = static_cast<int>(m),
                       .points = {}};
    for (const TargetFrame* frame : frames) {
      if (!frame->estimates[m]) continue;
      series.points.push_back({SecondsFromUtime(frame->utime), frame->estimates[m]->range_m});
    }
    chart.series.push_back(std::move(series));
  }
  chart.series.push_back(std::move(truth));
  // Far-off estimates would flatten the rest of the chart.
  chart.y_max = 1.5 * farthest_m;
  return chart;
}

}  // namespace

std::string ErrorByDistanceChart(const Evaluation& evaluation) {
  Chart chart;
  chart.title = "Relative error by distance (5 m bins, mean and 95 % interval)";
  chart.x_label = "distance, m";
  chart.y_label = "mean |d - d*| / d*";
  int look = 0;
  const double n_methods = static_cast<double>(evaluation.methods.size());
  for (const MethodScore& method : evaluation.methods) {
    ChartSeries series{.name = method.method,
                       .style = ChartSeries::Style::kLineWithPoints,
                       .look = look,
                       .points = {}};
    // Side by side, so that intervals do not hide each other.
    const double shift_m = (look - (n_methods - 1) / 2) * 0.35;
    for (const DistanceBin& bin : method.by_distance) {
      if (!bin.metrics.abs_rel) continue;
      ChartPoint point{(bin.from_m + bin.to_m) / 2 + shift_m, *bin.metrics.abs_rel};
      const auto interval = bin.metrics.ci95.find("abs_rel");
      if (interval != bin.metrics.ci95.end()) {
        point.low = interval->second[0];
        point.high = interval->second[1];
      }
      series.points.push_back(point);
    }
    chart.series.push_back(std::move(series));
    ++look;
  }
  return ChartSvg(chart);
}

std::string RangeOverTimeCharts(const Evaluation& evaluation) {
  std::map<std::pair<int, int>, PairFrames> pairs;
  for (const TargetFrame& frame : evaluation.targets.frames) {
    pairs[{frame.observer_id, frame.truth.target_id}].push_back(&frame);
  }
  std::string html;
  std::size_t n_drawn = 0;
  for (const auto& [pair, frames] : pairs) {
    if (n_drawn++ == kMaxPairs) {
      html += fmt::format("<p class=\"note\">{} more pairs are in estimates.csv.</p>\n",
                          pairs.size() - kMaxPairs);
      break;
    }
    html += ChartSvg(RangeOverTime(evaluation, pair.first, pair.second, frames));
  }
  return html;
}

}  // namespace windhover
