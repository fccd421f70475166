#include "dataset/data_card.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/config/enum_name.h"
#include "common/file/sha256.h"
#include "common/file/whole_file.h"
#include "common/image/image_codecs.h"
#include "dataset/box_text.h"
#include "dataset/export.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

// Files first, folders after, each in order of name: the same on every file system.
void HashFolder(const fs::path& root, const fs::path& folder, std::ostream* out) {
  std::vector<fs::path> files, folders;
  for (const auto& entry : fs::directory_iterator(folder)) {
    (entry.is_directory() ? folders : files).push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::sort(folders.begin(), folders.end());
  for (const fs::path& file : files) {
    const std::string name = fs::relative(file, root).string();
    if (name.starts_with("SHA256SUMS") || name == "dataset.json") continue;
    const std::string hash = Sha256OfFile(file);
    if (hash.empty()) throw std::runtime_error(fmt::format("{}: cannot be read", file.string()));
    *out << hash << "  " << name << '\n';
  }
  for (const fs::path& next : folders) HashFolder(root, next, out);
}

template <typename Counts>
ordered_json HistogramOf(const Counts& counts, int step, const char* unit) {
  const auto last = std::find_if(counts.rbegin(), counts.rend(), [](int n) { return n > 0; });
  ordered_json edges = ordered_json::array(), values = ordered_json::array();
  for (auto bin = counts.begin(); bin != last.base(); ++bin) {
    edges.push_back(step * (bin - counts.begin()));
    values.push_back(*bin);
  }
  edges.push_back(step * (last.base() - counts.begin()));
  return {{fmt::format("edges_{}", unit), edges}, {"counts", values}};
}

constexpr const char* kLicence =
    "CC0-1.0 for what windhover draws itself; meshes, photos and panoramas that the scenario names "
    "bring their own";

}  // namespace

DataCard::DataCard(const ExportPlan& plan) : plan_(plan) {
  for (const FlightSource::Flight& flight : plan.source.flights) {
    n_pairs_ += flight.n_pairs;
    ++counts_[flight.split].flights;
  }
}

void DataCard::Add(const LabelledPair& pair, const fs::path& image) {
  Counts& counts = counts_[pair.id.split];
  ++counts.pairs;
  CountTargets(pair, &counts);
  const int every = std::max(1, n_pairs_ / kThumbnails);
  const bool is_shown = pair.id.number % every == every / 2;
  if (!image.empty() && is_shown && std::ssize(thumbnails_) < kThumbnails) {
    AddThumbnail(pair, image);
  }
}

void DataCard::CountTargets(const LabelledPair& pair, Counts* counts) const {
  const auto bin = [](double value, int step) {
    return static_cast<std::size_t>(std::clamp(static_cast<int>(value / step), 0, kBins - 1));
  };
  for (const target_annotation_t& target : pair.annotation.targets) {
    if (target.left.visible.w_px <= 0 || target.right.visible.w_px <= 0) continue;
    ++counts->targets;
    // A share of a thousandth is less than a row of pixels.
    const auto either = [&](double target_view_t::*share) {
      return std::max(target.left.*share, target.right.*share) > 1e-3;
    };
    counts->truncated += either(&target_view_t::truncation);
    counts->occluded += either(&target_view_t::occlusion);
    ++counts->by_distance[bin(target.range_m, kDistanceStep_m)];
    ++counts->by_width[bin(target.left.visible.w_px, kSizeStep_px)];
  }
}

void DataCard::AddThumbnail(const LabelledPair& pair, const fs::path& image) {
  constexpr int kWidth_px = 480;
  const cv::Mat whole = Codecs().imread((plan_.folder / image).string(), cv::IMREAD_COLOR);
  if (whole.empty()) {
    throw std::runtime_error(fmt::format("{}: cannot be read", (plan_.folder / image).string()));
  }
  const double scale = static_cast<double>(kWidth_px) / whole.cols;
  cv::Mat small;
  cv::resize(whole, small, {}, scale, scale, cv::INTER_AREA);
  const cv::Scalar colour(40, 220, 255);
  for (const target_annotation_t& target : pair.annotation.targets) {
    if (target.left.visible.w_px <= 0) continue;
    const BoxEdges box = EdgesOf(target.left.visible);
    const cv::Point corner(static_cast<int>(box.left_px * scale) - 2,
                           static_cast<int>(box.top_px * scale) - 2);
    const cv::Point end(static_cast<int>(box.right_px * scale) + 2,
                        static_cast<int>(box.bottom_px * scale) + 2);
    cv::rectangle(small, corner, end, colour);
    cv::putText(small, fmt::format("{:.1f} m", target.range_m),
                {corner.x, std::max(corner.y - 4, 12)}, cv::FONT_HERSHEY_SIMPLEX, 0.4, colour, 1,
                cv::LINE_AA);
  }
  cv::putText(small, fmt::format("{} {}", pair.id.flight, pair.id.tick), {6, small.rows - 8},
              cv::FONT_HERSHEY_SIMPLEX, 0.4, cv::Scalar(255, 255, 255), 1, cv::LINE_AA);
  thumbnails_.push_back(small);
}

void DataCard::WriteContactSheet() const {
  if (thumbnails_.empty()) return;
  constexpr int kColumns = 4;
  const int n = static_cast<int>(thumbnails_.size());
  const cv::Size cell = thumbnails_.front().size();
  cv::Mat sheet(cell.height * ((n + kColumns - 1) / kColumns), cell.width * std::min(n, kColumns),
                CV_8UC3, cv::Scalar(0, 0, 0));
  for (int i = 0; i < n; ++i) {
    const cv::Mat& thumbnail = thumbnails_[static_cast<std::size_t>(i)];
    if (thumbnail.size() != cell) continue;
    thumbnail.copyTo(
        sheet({i % kColumns * cell.width, i / kColumns * cell.height, cell.width, cell.height}));
  }
  std::vector<std::uint8_t> png;
  Codecs().imencode(".png", sheet, png, {});
  ReplaceFile(plan_.folder / "contact_sheet.png",
              {reinterpret_cast<const char*>(png.data()), png.size()});
}

std::string DataCard::Readme() const {
  std::string text = fmt::format(
      "# {} pairs of stereo images with UAVs\n\nMade by windhover {}:\n\n    {}\n\n"
      "Layout `{}`, scenario `{}`, seed {}. [dataset.json](dataset.json) has the counts as "
      "numbers, "
      "`sha256sum -c SHA256SUMS` checks the files.\nLicence: {}.\n\n"
      "| split | flights | pairs | targets in both images | truncated | partly hidden |\n"
      "|---|---|---|---|---|---|\n",
      n_pairs_, plan_.version, plan_.command, NameOf(plan_.format), plan_.scenario,
      plan_.source.seed, kLicence);
  for (const auto& [split, counts] : counts_) {
    text += fmt::format("| {} | {} | {} | {} | {} | {} |\n", NameOf(split), counts.flights,
                        counts.pairs, counts.targets, counts.truncated, counts.occluded);
  }
  text += "\n| distance, m | targets |\n|---|---|\n";
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    int n = 0;
    for (const auto& [split, counts] : counts_) n += counts.by_distance[bin];
    if (n > 0) {
      text +=
          fmt::format("| {}–{} | {} |\n", bin * kDistanceStep_m, (bin + 1) * kDistanceStep_m, n);
    }
  }
  if (plan_.images.clean_twins) {
    text += "\n`clean/` has each image without noise and blur, with the same labels.\n";
  }
  if (plan_.images.dense) {
    text +=
        "\n`dense/` has a folder for each pair, of bodies without propellers in the middle of the "
        "exposure: depth_left.png, depth_right.png (Z), disparity.png (of the left image), 16 bit, "
        "value / 256 is m or px; mask_left.png, mask_right.png (position in the scenario plus 1); "
        "0 "
        "where no aircraft is.\n";
  }
  return text + (thumbnails_.empty() ? "" : "\n![contact sheet](contact_sheet.png)\n");
}

std::string DataCard::Json() const {
  ordered_json json = {{"format", "windhover-dataset"},
                       {"version", plan_.version},
                       {"command", plan_.command},
                       {"layout", NameOf(plan_.format)},
                       {"scenario", plan_.scenario},
                       {"seed", plan_.source.seed},
                       {"pairs", n_pairs_},
                       {"licence", kLicence}};
  for (const auto& [split, counts] : counts_) {
    json["splits"][NameOf(split)] = {
        {"flights", counts.flights},
        {"pairs", counts.pairs},
        {"targets_in_both_images", counts.targets},
        {"truncated", counts.truncated},
        {"partly_hidden", counts.occluded},
        {"distance", HistogramOf(counts.by_distance, kDistanceStep_m, "m")},
        {"box_width", HistogramOf(counts.by_width, kSizeStep_px, "px")}};
  }
  json["sha256_of_SHA256SUMS"] = Sha256OfFile(plan_.folder / "SHA256SUMS");
  json["resolved_scenario"] = plan_.source.resolved_yaml;
  return json.dump(2) + "\n";
}

void DataCard::Write() const {
  WriteContactSheet();
  ReplaceFile(plan_.folder / "README.md", Readme());
  WholeFile sums(plan_.folder / "SHA256SUMS");
  HashFolder(plan_.folder, plan_.folder, &sums.out());
  sums.Commit();
  ReplaceFile(plan_.folder / "dataset.json", Json());
}

}  // namespace windhover
