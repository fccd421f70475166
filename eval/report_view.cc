#include "eval/report_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "eval/report_flight.h"

namespace windhover {
namespace {

constexpr std::size_t kMaxMoments = 200;  // Of the replay: an image each tenth of a second.
constexpr double kFarthest_px = 1e5;      // Beyond, a log is broken.
constexpr const char* kOutside = "-9999";

/// One box in the course of the replay: its corner and size as values of SVG animations.
struct BoxCourse {
  std::array<std::string, 4> values;  ///< x, y, width, height.
  std::size_t n = 0;                  ///< Moments so far.

  /// Fills up with moments in which there is none.
  void SkipTo(std::size_t moment) {
    for (; n < moment; ++n) Append(kOutside, kOutside, "0", "0");
  }
  void Add(std::size_t moment, const image_box_t& box) {
    SkipTo(moment);
    const auto px = [](double value) { return fmt::format("{:.0f}", value); };
    // The drawing's (0, 0) is a corner of the top-left pixel; the box's is its centre.
    Append(px(box.x_px + 0.5 - box.w_px / 2), px(box.y_px + 0.5 - box.h_px / 2), px(box.w_px),
           px(box.h_px));
    ++n;
  }

 private:
  void Append(const std::string& x, const std::string& y, const std::string& width,
              const std::string& height) {
    const char* between = values[0].empty() ? "" : ";";
    values[0] += between + x;
    values[1] += between + y;
    values[2] += between + width;
    values[3] += between + height;
  }
};

bool CanBeDrawn(const image_box_t& box) {
  const auto is_near = [](double px) { return std::abs(px) < kFarthest_px; };  // Nor NaN.
  return box.w_px > 0 && is_near(box.x_px) && is_near(box.y_px) && is_near(box.w_px) &&
         is_near(box.h_px);
}

struct Courses {
  std::map<int, BoxCourse> truth;  ///< By target.
  std::vector<BoxCourse> detected;
};

Courses CoursesOf(const std::vector<const ObserverFrame*>& moments) {
  Courses courses;
  for (std::size_t k = 0; k < moments.size(); ++k) {
    for (const target_annotation_t& target : moments[k]->truth.targets) {
      if (!CanBeDrawn(target.left.visible)) continue;
      courses.truth[target.target_id].Add(k, target.left.visible);
    }
    if (!moments[k]->detections) continue;
    std::size_t n = 0;
    for (const stereo_box_t& box : moments[k]->detections->boxes) {
      if (!CanBeDrawn(box.left)) continue;
      if (n == courses.detected.size()) courses.detected.emplace_back();
      courses.detected[n++].Add(k, box.left);
    }
  }
  for (auto& [id, course] : courses.truth) course.SkipTo(moments.size());
  for (BoxCourse& course : courses.detected) course.SkipTo(moments.size());
  return courses;
}

std::string Animate(const char* attribute, const std::string& values, double duration_s) {
  return fmt::format(
      "<animate attributeName=\"{}\" dur=\"{:g}s\" repeatCount=\"indefinite\" "
      "calcMode=\"discrete\" values=\"{}\"/>",
      attribute, duration_s, values);
}

std::string RectSvg(const BoxCourse& course, const char* css_class, double duration_s) {
  static constexpr const char* kAttributes[] = {"x", "y", "width", "height"};
  std::string svg = fmt::format("<rect class=\"{}\">", css_class);
  for (std::size_t i = 0; i < 4; ++i) {
    svg += Animate(kAttributes[i], course.values[i], duration_s);
  }
  return svg + "</rect>\n";
}

}  // namespace

std::string ObserverView(const RunRecord& run) {
  const auto first = std::min_element(
      run.frames.begin(), run.frames.end(),
      [](const ObserverFrame& a, const ObserverFrame& b) { return a.observer_id < b.observer_id; });
  if (first == run.frames.end()) return "";
  std::vector<const ObserverFrame*> frames, moments;
  for (const ObserverFrame& frame : run.frames) {
    if (frame.observer_id == first->observer_id) frames.push_back(&frame);
  }
  const std::size_t step = (frames.size() + kMaxMoments - 1) / kMaxMoments;
  for (std::size_t k = 0; k < frames.size(); k += step) moments.push_back(frames[k]);
  const Courses courses = CoursesOf(moments);
  if (courses.truth.empty() && courses.detected.empty()) return "";
  const double duration_s = ReplayDuration_s(frames.front()->utime, frames.back()->utime);
  const auto& image = run.scenario.rig.calibrated.image;
  std::string svg = fmt::format(
      "<svg class=\"frame\" viewBox=\"0 0 {0} {1}\" role=\"img\" aria-label=\"boxes in the left "
      "image of aircraft {2}\"><rect class=\"no-picture\" width=\"{0}\" height=\"{1}\"/>\n",
      image[0], image[1], first->observer_id);
  for (const auto& [id, course] : courses.truth) {
    svg += RectSvg(course, "truth-box", duration_s);
    svg += fmt::format("<text class=\"box-label\" dy=\"-8\">{}{}{}</text>\n", id,
                       Animate("x", course.values[0], duration_s),
                       Animate("y", course.values[1], duration_s));
  }
  for (const BoxCourse& course : courses.detected) {
    svg += RectSvg(course, "detected-box", duration_s);
  }
  return fmt::format(
      "<figure>{}</svg><figcaption>aircraft {}, left, replayed: where the others are (dashed, with "
      "their numbers) and what was detected (solid)</figcaption></figure>\n",
      svg, first->observer_id);
}

}  // namespace windhover
