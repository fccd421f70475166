#include "eval/report_frames.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <regex>
#include <vector>

#include <fmt/format.h>

namespace windhover {
namespace {

constexpr std::size_t kMaxPictures = 6;

struct Picture {
  std::filesystem::path file;
  std::string media_type;
  Utime utime;
  int observer_id;
  bool is_left;
};

std::optional<Picture> PictureNamed(const std::filesystem::path& file) {
  static const std::regex pattern(R"((\d{1,15})_(\d{1,6})_(left|right)\.(png|jpg))");
  std::smatch match;
  const std::string name = file.filename().string();
  if (!std::regex_match(name, match, pattern)) return std::nullopt;
  return Picture{file, match[4] == "png" ? "image/png" : "image/jpeg", std::stoll(match[1]),
                 std::stoi(match[2]), match[3] == "left"};
}

/// Those of the first aircraft that has any, in order of time.
std::vector<Picture> FindPictures(const std::filesystem::path& frames_dir) {
  std::vector<Picture> pictures;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(frames_dir, ignored)) {
    if (const auto picture = PictureNamed(entry.path())) pictures.push_back(*picture);
  }
  const auto first = std::min_element(
      pictures.begin(), pictures.end(),
      [](const Picture& a, const Picture& b) { return a.observer_id < b.observer_id; });
  if (first == pictures.end()) return {};
  const int first_id = first->observer_id;
  std::erase_if(pictures, [&](const Picture& picture) { return picture.observer_id != first_id; });
  std::sort(pictures.begin(), pictures.end(),
            [](const Picture& a, const Picture& b) { return a.file < b.file; });
  std::stable_sort(pictures.begin(), pictures.end(),
                   [](const Picture& a, const Picture& b) { return a.utime < b.utime; });
  return pictures;
}

std::string BoxSvg(const image_box_t& box, const char* css_class) {
  if (!(box.w_px > 0)) return "";
  // The drawing's (0, 0) is a corner of the top-left pixel; the box's is its centre.
  return fmt::format(
      "<rect class=\"{}\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/>",
      css_class, box.x_px + 0.5 - box.w_px / 2, box.y_px + 0.5 - box.h_px / 2, box.w_px, box.h_px);
}

std::string BoxesSvg(const ObserverFrame& frame, bool is_left) {
  std::string svg;
  for (const target_annotation_t& target : frame.truth.targets) {
    svg += BoxSvg(is_left ? target.left.visible : target.right.visible, "truth-box");
  }
  if (!frame.detections) return svg;
  for (const stereo_box_t& box : frame.detections->boxes) {
    svg += BoxSvg(is_left ? box.left : box.right, "detected-box");
  }
  return svg;
}

std::string PictureHtml(const RunRecord& run, const Picture& picture) {
  std::ifstream in(picture.file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (bytes.empty()) return "";
  const auto frame = std::find_if(run.frames.begin(), run.frames.end(), [&](auto& f) {
    return f.utime == picture.utime && f.observer_id == picture.observer_id;
  });
  const auto& image = run.scenario.rig.calibrated.image;
  return fmt::format(
      "<figure><svg class=\"frame\" viewBox=\"0 0 {0} {1}\"><image width=\"{0}\" height=\"{1}\" "
      "href=\"data:{2};base64,{3}\"/>{4}</svg><figcaption>aircraft {5}, {6}, t = {7:.2f} s"
      "</figcaption></figure>\n",
      image[0], image[1], picture.media_type, Base64(bytes),
      frame == run.frames.end() ? "" : BoxesSvg(*frame, picture.is_left), picture.observer_id,
      picture.is_left ? "left" : "right", SecondsFromUtime(picture.utime));
}

}  // namespace

std::string Base64(const std::string& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = i; k < i + 3; ++k) {
      group = group << 8 | (k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63];
    }
  }
  return text;
}

std::string FramesHtml(const Evaluation& evaluation, const std::filesystem::path& frames_dir) {
  const std::vector<Picture> pictures = FindPictures(frames_dir);
  if (pictures.empty()) return "";
  std::string html;
  const std::size_t n = std::min(pictures.size(), kMaxPictures);
  for (std::size_t i = 0; i < n; ++i) {
    // Spread over the flight.
    html += PictureHtml(evaluation.run, pictures[i * pictures.size() / n]);
  }
  return html;
}

}  // namespace windhover
