#include "learn/detector/labelled_folder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/config/fields.h"
#include "common/image/image_codecs.h"
#include "common/image/image_header.h"
#include "learn/detector/picture_samples.h"
#include "network/box_decoding.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

constexpr int kGrey = 114;  // As beyond the borders of a picture (network/detector_input.h).
constexpr std::uintmax_t kMostLabelBytes = 1 << 20;
constexpr std::size_t kMostMistakes = 20;
constexpr double kMargin = 1e-3;  // Shares are written rounded.

bool IsPicture(const fs::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".jpg" || ending == ".jpeg" || ending == ".png";
}

std::vector<fs::path> PicturesIn(const fs::path& folder) {
  std::vector<fs::path> pictures;
  if (!fs::is_directory(folder)) return pictures;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && IsPicture(entry.path())) pictures.push_back(entry.path());
  }
  std::sort(pictures.begin(), pictures.end());
  return pictures;
}

/// Centre and size in shares of the image; nothing if the line is none.
std::optional<std::array<double, 4>> SharesOf(const std::string& line) {
  std::istringstream words(line);
  std::vector<std::string> parts{std::istream_iterator<std::string>(words), {}};
  if (parts.size() != 5) return std::nullopt;
  if (!std::all_of(parts[0].begin(), parts[0].end(), [](char c) { return c >= '0' && c <= '9'; })) {
    return std::nullopt;
  }
  std::array<double, 4> shares{};
  for (std::size_t i = 0; i < 4; ++i) {
    char* end = nullptr;
    shares[i] = std::strtod(parts[i + 1].c_str(), &end);
    if (*end != '\0' || !(shares[i] >= 0 && shares[i] <= 1)) return std::nullopt;
  }
  const auto is_inside = [](double middle, double size) {
    return size > 0 && middle - size / 2 >= -kMargin && middle + size / 2 <= 1 + kMargin;
  };
  if (!is_inside(shares[0], shares[2]) || !is_inside(shares[1], shares[3])) return std::nullopt;
  return shares;
}

/// Reads files and collects what is wrong with them.
class FolderReader {
 public:
  explicit FolderReader(const fs::path& folder) : folder_(folder) {}

  std::vector<std::array<double, 4>> ReadLabels(const fs::path& picture) {
    fs::path file = folder_ / "labels" / fs::relative(picture, folder_ / "images");
    file.replace_extension(".txt");
    std::vector<std::array<double, 4>> labels;
    std::ifstream in(file);
    if (!in || !fs::is_regular_file(file)) {
      Wrong(
          fmt::format("{}: must have a label file (found no {})", picture.string(), file.string()));
      return labels;
    }
    if (fs::file_size(file) > kMostLabelBytes) {
      Wrong(fmt::format("{}: must have at most {} bytes (found {})", file.string(), kMostLabelBytes,
                        fs::file_size(file)));
      return labels;
    }
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
      if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
      if (const auto shares = SharesOf(line)) {
        labels.push_back(*shares);
        continue;
      }
      Wrong(
          fmt::format("{}:{}: must be \"class x y w h\", a whole number and a box inside the "
                      "image in shares of it (found '{:.80}')",
                      file.string(), number, line));
    }
    return labels;
  }

  cv::Mat ReadPicture(const fs::path& file) {
    cv::Mat bgr, rgb;
    try {
      CheckImageFile(file);
      bgr = Codecs().imread(file.string(), cv::IMREAD_COLOR);
    } catch (const ConfigError& error) {
      Wrong(fmt::format("{}: {}", file.string(), error.what()));
      return rgb;
    } catch (const cv::Exception&) {
    }
    if (bgr.empty()) {
      Wrong(fmt::format("{}: must be a picture that can be decoded", file.string()));
      return rgb;
    }
    cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
    return rgb;
  }

  void Wrong(std::string what) {
    if (++n_wrong_ <= kMostMistakes) mistakes_ += (n_wrong_ > 1 ? "\n" : "") + what;
  }

  void ThrowIfWrong() const {
    if (n_wrong_ == 0) return;
    const std::string more =
        n_wrong_ > kMostMistakes ? fmt::format("\nand {} more", n_wrong_ - kMostMistakes) : "";
    throw ConfigError(mistakes_ + more);
  }

 private:
  const fs::path& folder_;
  std::string mistakes_;
  std::size_t n_wrong_ = 0;
};

image_box_t BoxOf(const std::array<double, 4>& shares, const cv::Mat& rgb) {
  image_box_t box{};
  box.x_px = shares[0] * rgb.cols - 0.5;
  box.y_px = shares[1] * rgb.rows - 0.5;
  box.w_px = shares[2] * rgb.cols;
  box.h_px = shares[3] * rgb.rows;
  return box;
}

class MixedSource final : public DetectorSampleSource {
 public:
  MixedSource(std::unique_ptr<DetectorSampleSource> own,
              std::unique_ptr<DetectorSampleSource> other, double share)
      : own_(std::move(own)), other_(std::move(other)), share_(share) {}

  std::vector<DetectorSample> Batch(int step) override {
    std::vector<DetectorSample> batch = own_->Batch(step), others = other_->Batch(step);
    const auto n = static_cast<std::size_t>(std::max(
        1L, std::lround(share_ * static_cast<double>(std::min(batch.size(), others.size())))));
    std::move(others.begin() + static_cast<std::ptrdiff_t>(n),
              others.begin() + static_cast<std::ptrdiff_t>(std::min(batch.size(), others.size())),
              batch.begin() + static_cast<std::ptrdiff_t>(n));
    return batch;
  }

 private:
  std::unique_ptr<DetectorSampleSource> own_, other_;
  double share_;
};

}  // namespace

std::vector<LabelledFile> ReadLabelledFolder(const fs::path& folder, std::size_t most) {
  const std::vector<fs::path> pictures = PicturesIn(folder / "images");
  if (pictures.empty()) {
    throw ConfigError(
        fmt::format("{}: must have pictures (.jpg or .png) under images/ and their "
                    "labels under labels/ (found none)",
                    folder.string()));
  }
  FolderReader reader(folder);
  std::vector<std::vector<std::array<double, 4>>> labels;
  for (const fs::path& picture : pictures) labels.push_back(reader.ReadLabels(picture));
  const std::size_t n = std::min(most, pictures.size());
  std::vector<LabelledFile> files;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = k * pictures.size() / n;
    LabelledFile file{.file = pictures[i], .rgb = reader.ReadPicture(pictures[i]), .boxes = {}};
    for (const auto& shares : labels[i]) file.boxes.push_back(BoxOf(shares, file.rgb));
    files.push_back(std::move(file));
  }
  reader.ThrowIfWrong();
  return files;
}

std::vector<LabelledPicture> PicturesOf(const LabelledFile& labelled) {
  std::vector<LabelledPicture> pictures;
  for (const image_box_t& box : labelled.boxes) {
    LabelledPicture picture;
    picture.rgb = labelled.rgb.clone();
    picture.box = box;
    for (const image_box_t& other : labelled.boxes) {
      if (&other == &box || OverlapOf(other, box) > 0) continue;
      const cv::Rect2d area(other.x_px - other.w_px / 2, other.y_px - other.h_px / 2, other.w_px,
                            other.h_px);
      cv::rectangle(picture.rgb, cv::Rect(area), cv::Scalar::all(kGrey), cv::FILLED);
    }
    pictures.push_back(std::move(picture));
  }
  if (pictures.empty()) pictures.emplace_back().rgb = labelled.rgb;
  return pictures;
}

std::unique_ptr<DetectorSampleSource> MakeFolderSource(const std::vector<LabelledFile>& files,
                                                       bool is_refinement, ReplayConfig replay) {
  std::vector<DetectorSample> samples;
  for (const LabelledFile& file : files) {
    for (const LabelledPicture& picture : PicturesOf(file)) {
      if (!is_refinement) {
        samples.push_back(WholeSample(picture));
        continue;
      }
      constexpr int kRefinements = 12;
      RandomStream random(replay.seed, fmt::format("folder/{}", samples.size()));
      auto more = RefinementSamples(picture, kRefinements, {}, &random);
      std::move(more.begin(), more.end(), std::back_inserter(samples));
    }
  }
  replay.first_scenes = replay.scenes_kept = 1;
  if (is_refinement) replay.whole_every = 0;
  return std::make_unique<ReplaySource>([samples](int) { return samples; }, replay);
}

std::unique_ptr<DetectorSampleSource> Mixed(std::unique_ptr<DetectorSampleSource> own,
                                            std::unique_ptr<DetectorSampleSource> other,
                                            double share) {
  return std::make_unique<MixedSource>(std::move(own), std::move(other), share);
}

}  // namespace windhover
