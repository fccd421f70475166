#include "eval/report_flight.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>

#include "eval/svg_chart.h"
#include "eval/text_file.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kMaxPoints = 300;  // Of a path: more would not be told apart.
constexpr double kWidth = 520, kLeft = 52, kRight = 14, kTop = 14, kBottom = 40;
constexpr double kMinAspect = 0.35, kMaxAspect = 1.1;  // Height of a view by its width.
constexpr double kLongest_s = 20;                      // Of a replay; longer flights run faster.
constexpr int kLooks = 6;
constexpr double kFarthest_m = 1e7;  // Beyond, a log is broken.

/// Two aircraft at one tick.
struct Approach {
  double distance_m = std::numeric_limits<double>::infinity();
  Utime utime = 0;
  int one = 0, other = 0;
  Vector3d middle_W_m = Vector3d::Zero();
};

Approach ClosestAt(const world_truth_t& tick) {
  Approach closest;
  for (std::size_t i = 0; i < tick.uavs.size(); ++i) {
    for (std::size_t j = i + 1; j < tick.uavs.size(); ++j) {
      const Vector3d a(tick.uavs[i].p_WB_m), b(tick.uavs[j].p_WB_m);
      if ((a - b).norm() >= closest.distance_m) continue;
      closest = {(a - b).norm(), tick.utime, tick.uavs[i].id, tick.uavs[j].id, (a + b) / 2};
    }
  }
  return closest;
}

Approach ClosestOf(const RunRecord& run) {
  Approach closest;
  for (const world_truth_t& tick : run.world) {
    const Approach now = ClosestAt(tick);
    if (now.distance_m < closest.distance_m) closest = now;
  }
  return closest;
}

bool CanBeDrawn(const RunRecord& run) {
  if (run.world.empty() || run.world.front().uavs.empty()) return false;
  return std::all_of(run.world.begin(), run.world.end(), [](const world_truth_t& tick) {
    return std::all_of(tick.uavs.begin(), tick.uavs.end(), [](const uav_truth_t& uav) {
      const Vector3d p_m(uav.p_WB_m);
      return p_m.allFinite() && p_m.cwiseAbs().maxCoeff() < kFarthest_m;
    });
  });
}

std::size_t StepOf(const RunRecord& run) {
  return std::max<std::size_t>(1, (run.world.size() + kMaxPoints - 1) / kMaxPoints);
}

/// Metres of two axes of W to the drawing's coordinates, both at one scale.
struct View {
  int across, up;  ///< Axes of W.
  Vector3d low_m, high_m;
  double px_per_m, height;

  double X(const Vector3d& p_m) const { return kLeft + (p_m[across] - low_m[across]) * px_per_m; }
  double Y(const Vector3d& p_m) const {
    return height - kBottom - (p_m[up] - low_m[up]) * px_per_m;
  }
};

/// Makes room so that the extent along `axis` is `length_m`.
void Widen(int axis, double length_m, View* view) {
  const double missing_m = length_m - (view->high_m[axis] - view->low_m[axis]);
  if (missing_m <= 0) return;
  view->low_m[axis] -= missing_m / 2;
  view->high_m[axis] += missing_m / 2;
}

View FitView(const RunRecord& run, int across, int up) {
  View view{across,
            up,
            Vector3d::Constant(std::numeric_limits<double>::infinity()),
            Vector3d::Constant(-std::numeric_limits<double>::infinity()),
            1,
            0};
  for (const world_truth_t& tick : run.world) {
    for (const uav_truth_t& uav : tick.uavs) {
      view.low_m = view.low_m.cwiseMin(Vector3d(uav.p_WB_m));
      view.high_m = view.high_m.cwiseMax(Vector3d(uav.p_WB_m));
    }
  }
  const double longest_m = std::max((view.high_m - view.low_m).maxCoeff(), 1.0);
  view.low_m -= Vector3d::Constant(0.06 * longest_m);
  view.high_m += Vector3d::Constant(0.06 * longest_m);
  const auto length_m = [&](int axis) { return view.high_m[axis] - view.low_m[axis]; };
  Widen(up, kMinAspect * length_m(across), &view);
  Widen(across, length_m(up) / kMaxAspect, &view);
  view.px_per_m = (kWidth - kLeft - kRight) / length_m(across);
  view.height = kTop + kBottom + length_m(up) * view.px_per_m;
  return view;
}

std::string GridSvg(const View& view) {
  const double across_m = view.high_m[view.across] - view.low_m[view.across];
  const double step_m = NiceTicks(across_m).at(1);
  std::string svg;
  const auto for_each_tick = [&](int axis, auto draw) {
    const double first = std::ceil(view.low_m[axis] / step_m);
    for (double k = first; k * step_m <= view.high_m[axis]; ++k) {
      Vector3d at_m = view.low_m;
      at_m[axis] = k * step_m;
      draw(at_m, k * step_m + 0.0);  // No -0.
    }
  };
  for_each_tick(view.across, [&](const Vector3d& at_m, double value) {
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2:.1f}\"/>"
        "<text x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4:g}</text>\n",
        view.X(at_m), kTop, view.height - kBottom, view.height - kBottom + 15, value);
  });
  for_each_tick(view.up, [&](const Vector3d& at_m, double value) {
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>"
        "<text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5:g}</text>\n",
        kLeft, kWidth - kRight, view.Y(at_m), kLeft - 6, view.Y(at_m) + 4, value);
  });
  return svg;
}

/// The path of aircraft number `i`, and a disc with its id that moves along it in `duration_s`.
std::string AircraftSvg(const RunRecord& run, const View& view, const std::string& name,
                        std::size_t i, double duration_s) {
  std::string path;
  int id = 0;
  for (std::size_t k = 0; k < run.world.size(); k += StepOf(run)) {
    if (i >= run.world[k].uavs.size()) continue;
    const uav_truth_t& uav = run.world[k].uavs[i];
    const Vector3d p_m(uav.p_WB_m);
    id = uav.id;
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", view.X(p_m), view.Y(p_m));
  }
  return fmt::format(
      "<path id=\"{0}{1}\" class=\"line s{2}\" d=\"{3}\"/>"
      "<g class=\"mark s{2}\"><animateMotion dur=\"{4:g}s\" repeatCount=\"indefinite\" "
      "calcMode=\"linear\"><mpath href=\"#{0}{1}\"/></animateMotion>"
      "<circle r=\"5\"/><text x=\"7\" y=\"-6\" stroke=\"none\">{1}</text></g>\n",
      name, id, i % kLooks, path, duration_s);
}

std::string ViewSvg(const RunRecord& run, const Approach& closest, const View& view,
                    const std::string& name, const std::string& title, double duration_s) {
  static constexpr const char* kAxes[] = {"east, m", "north, m", "up, m"};
  std::string svg = fmt::format(
      "<figure><figcaption>{0}</figcaption><svg class=\"chart\" viewBox=\"0 0 {1} {2:.0f}\" "
      "role=\"img\" aria-label=\"{0}\">\n",
      XmlEscaped(title), kWidth, view.height);
  svg += GridSvg(view);
  svg += fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"middle\">{}</text>\n",
                     (kLeft + kWidth - kRight) / 2, view.height - 8, kAxes[view.across]);
  svg += fmt::format(
      "<text transform=\"translate(14,{:.0f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      (kTop + view.height - kBottom) / 2, kAxes[view.up]);
  for (std::size_t i = 0; i < run.world.front().uavs.size(); ++i) {
    svg += AircraftSvg(run, view, name, i, duration_s);
  }
  if (std::isfinite(closest.distance_m)) {
    svg += fmt::format("<path class=\"line truth\" d=\"M{:.1f} {:.1f}l10 10m0 -10l-10 10\"/>\n",
                       view.X(closest.middle_W_m) - 5, view.Y(closest.middle_W_m) - 5);
  }
  return svg + "</svg></figure>\n";
}

}  // namespace

double ReplayDuration_s(Utime first, Utime last) {
  return std::clamp(SecondsFromUtime(last - first), 0.1, kLongest_s);
}

std::string FlightViews(const RunRecord& run) {
  if (!CanBeDrawn(run)) return "";
  const double flight_s = SecondsFromUtime(run.world.back().utime - run.world.front().utime);
  const double duration_s = ReplayDuration_s(run.world.front().utime, run.world.back().utime);
  const Approach closest = ClosestOf(run);
  const View top = FitView(run, 0, 1);
  const Vector3d extent_m = top.high_m - top.low_m;
  std::string html = "<div class=\"frames\">\n" +
                     ViewSvg(run, closest, top, "above-", "From above", duration_s) +
                     ViewSvg(run, closest, FitView(run, extent_m.x() >= extent_m.y() ? 0 : 1, 2),
                             "side-", "From the side", duration_s) +
                     "</div>\n";
  std::string note = "Discs show where each aircraft was";
  if (flight_s > duration_s) note += fmt::format(", {:.2g} times as fast", flight_s / duration_s);
  return html + fmt::format(
                    "<p class=\"note\">{}{}.</p>\n", note,
                    std::isfinite(closest.distance_m) ? "; the cross, where two came closest" : "");
}

std::string SeparationChart(const RunRecord& run) {
  const Approach closest = ClosestOf(run);
  if (!std::isfinite(closest.distance_m)) return "";
  Chart chart{.title = "Smallest distance of any two aircraft",
              .x_label = "time, s",
              .y_label = "distance, m",
              .series = {}};
  ChartSeries distance{.name = "distance", .look = 0, .points = {}};
  for (std::size_t k = 0; k < run.world.size(); k += StepOf(run)) {
    const Approach now = ClosestAt(run.world[k]);
    distance.points.push_back({SecondsFromUtime(now.utime), now.distance_m});
  }
  const double end_s = SecondsFromUtime(run.world.back().utime);
  const auto limit = [&](const char* name, int look, double distance_m) {
    return ChartSeries{
        .name = name, .look = look, .points = {{0, distance_m}, {end_s, distance_m}}};
  };
  chart.series.push_back(std::move(distance));
  chart.series.push_back(limit("near miss", 4, run.scenario.score.near_miss_m));
  chart.series.push_back(limit("collision", 1, run.scenario.score.collision_m));
  chart.series.push_back(
      {.name = fmt::format("{:.2f} m: {} and {} at {:.1f} s", closest.distance_m, closest.one,
                           closest.other, SecondsFromUtime(closest.utime)),
       .style = ChartSeries::Style::kPoints,
       .look = 3,
       .points = {{SecondsFromUtime(closest.utime), closest.distance_m}}});
  return ChartSvg(chart);
}

}  // namespace windhover
