#include "learn/detector/detector_trial.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "common/file/whole_file.h"
#include "rig/fitted_box_noise.h"

namespace windhover {
namespace {

constexpr double kMinScore = 0.01;
/// From, to.
constexpr std::array<std::array<double, 2>, 10> kRanges_m = {{{4, 30},
                                                              {4, 8},
                                                              {8, 15},
                                                              {15, 22},
                                                              {22, 30},
                                                              {30, 40},
                                                              {40, 60},
                                                              {60, 90},
                                                              {90, 130},
                                                              {130, 180}}};
constexpr std::array<double, 7> kWidths_px = {16, 32, 64, 128, 256, 512, 1280};
constexpr int kScoreSteps = 20;

bool IsWithin(const image_box_t& found, const image_box_t& truth) {
  return std::abs(found.x_px - truth.x_px) <= truth.w_px / 2 &&
         std::abs(found.y_px - truth.y_px) <= truth.h_px / 2;
}

const LabelledBox& Label(const TriedPair& pair, std::size_t eye) {
  return pair.result.eyes[eye].labels.front();
}

double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

TrialScore::Bin BinOf(const std::vector<TriedPair>& pairs, double from_m, double to_m) {
  TrialScore::Bin bin{.from_m = from_m, .to_m = to_m};
  std::vector<double> centres, differences;
  double sum = 0;
  for (const TriedPair& pair : pairs) {
    if (!HasClearTarget(pair)) continue;
    const LabelledBox &left_label = Label(pair, 0), &right_label = Label(pair, 1);
    if (left_label.range_m < from_m || left_label.range_m >= to_m) continue;
    ++bin.n;
    const stereo_box_t* found = DetectionOf(pair);
    if (found == nullptr) continue;
    ++bin.n_found;
    const double left = found->left.x_px - left_label.box.x_px;
    const double right = found->right.x_px - right_label.box.x_px;
    centres.insert(centres.end(), {std::abs(left), std::abs(right)});
    differences.push_back(std::abs(left - right));
    sum += left + right;
  }
  bin.centre_px = Median(centres);
  bin.difference_px = Median(differences);
  if (!centres.empty()) bin.bias_px = sum / static_cast<double>(centres.size());
  return bin;
}

bool IsEmpty(const TriedPair& pair) {
  return pair.result.eyes[0].labels.empty() && pair.result.eyes[1].labels.empty();
}

BoxErrors::OneImage ErrorOf(const image_box_t& found, const image_box_t& truth) {
  return {found.x_px - truth.x_px, found.y_px - truth.y_px, found.w_px - truth.w_px,
          found.h_px - truth.h_px};
}

}  // namespace

std::vector<TriedPair> TryDetector(YoloxDetector* detector, const Scenario& base,
                                   const PictureConfig& pictures, int n_pairs,
                                   const std::function<bool(int done)>& on_pair) {
  std::vector<std::vector<stereo_box_t>> detections;  // In order: one thread draws.
  const auto detect = [&](const cv::Mat& left, const cv::Mat& right) -> FoundInPair {
    detections.push_back(detector->Detect(left, right));
    auto found = detector->DetectEach(left, right, kMinScore);
    return {std::move(found[0]), std::move(found[1])};
  };
  auto results = ShowPictures(base, pictures, n_pairs, /*threads=*/1, detect, on_pair);
  std::vector<TriedPair> pairs;
  for (std::size_t i = 0; i < detections.size(); ++i) {
    pairs.push_back({std::move(results[i]), std::move(detections[i])});
  }
  return pairs;
}

bool HasClearTarget(const TriedPair& pair) {
  return std::all_of(pair.result.eyes.begin(), pair.result.eyes.end(), [](const ImageResult& eye) {
    return eye.labels.size() == 1 && eye.labels.front().counts;
  });
}

const stereo_box_t* DetectionOf(const TriedPair& pair) {
  if (!HasClearTarget(pair)) return nullptr;
  for (const stereo_box_t& box : pair.detections) {  // Best first.
    if (IsWithin(box.left, Label(pair, 0).box) && IsWithin(box.right, Label(pair, 1).box)) {
      return &box;
    }
  }
  return nullptr;
}

std::vector<BoxErrorSample> ErrorSamples(const std::vector<TriedPair>& pairs) {
  std::vector<BoxErrorSample> samples;
  for (const TriedPair& pair : pairs) {
    if (!HasClearTarget(pair)) continue;
    const image_box_t &left = Label(pair, 0).box, &right = Label(pair, 1).box;
    BoxErrorSample& sample = samples.emplace_back();
    sample.sizes = {{{left.w_px, left.h_px}, {right.w_px, right.h_px}}};
    const stereo_box_t* found = DetectionOf(pair);
    if (found == nullptr) continue;
    sample.errors =
        BoxErrors{.left = ErrorOf(found->left, left), .right = ErrorOf(found->right, right)};
  }
  return samples;
}

TrialScore ScoreTrial(const std::vector<TriedPair>& pairs) {
  TrialScore score;
  score.bins.push_back(BinOf(pairs, 0, 1e9));
  for (const auto& [from_m, to_m] : kRanges_m) {
    const TrialScore::Bin bin = BinOf(pairs, from_m, to_m);
    if (bin.n > 0) score.bins.push_back(bin);
  }
  std::vector<ImageResult> images;
  for (const TriedPair& pair : pairs) {
    images.insert(images.end(), pair.result.eyes.begin(), pair.result.eyes.end());
    const int n = static_cast<int>(pair.detections.size());
    if (IsEmpty(pair)) {
      ++score.n_empty;
      score.n_false += n;
    } else if (HasClearTarget(pair)) {
      score.n_beside += n - (DetectionOf(pair) == nullptr ? 0 : 1);
    }
  }
  score.ap50 = AveragePrecision(images, 0.5);
  score.ap50_95 = MeanAveragePrecision(images);
  for (std::size_t i = 0; i + 1 < kWidths_px.size(); ++i) {
    const WidthRange widths{kWidths_px[i], kWidths_px[i + 1]};
    const auto ap50 = AveragePrecision(images, 0.5, widths);
    if (ap50) score.sizes.push_back({widths, ap50, MeanAveragePrecision(images, widths)});
  }
  return score;
}

std::vector<ScoreChoice> ScoreChoices(const std::vector<TriedPair>& pairs) {
  std::vector<ScoreChoice> choices;
  for (int step = 1; step < kScoreSteps; ++step) {
    ScoreChoice choice{.min_score = static_cast<double>(step) / kScoreSteps};
    const auto counts = [&](const stereo_box_t& box) { return box.score >= choice.min_score; };
    int n = 0, n_found = 0;
    for (const TriedPair& pair : pairs) {
      if (HasClearTarget(pair)) {
        const stereo_box_t* found = DetectionOf(pair);
        ++n;
        n_found += found != nullptr && counts(*found) ? 1 : 0;
      } else if (IsEmpty(pair)) {
        choice.n_false +=
            static_cast<int>(std::count_if(pair.detections.begin(), pair.detections.end(), counts));
      }
    }
    choice.recall = n == 0 ? 0 : static_cast<double>(n_found) / n;
    choices.push_back(choice);
  }
  return choices;
}

double QuietScore(const std::vector<ScoreChoice>& choices) {
  for (const ScoreChoice& choice : choices) {
    if (choice.n_false == 0) return choice.min_score;
  }
  throw std::invalid_argument("at every score something is found in empty pictures");
}

std::string ScoreChoicesText(const std::vector<ScoreChoice>& choices) {
  std::string text = "min_score  recall  false\n";
  for (const ScoreChoice& choice : choices) {
    text +=
        fmt::format("{:>9.2f} {:>7.3f} {:>6}\n", choice.min_score, choice.recall, choice.n_false);
  }
  return text;
}

std::string TrialText(const TrialScore& score) {
  std::string text = "range_m      n  recall  |x| px  |xL-xR| px  bias px\n";
  for (const TrialScore::Bin& bin : score.bins) {
    const std::string range =
        bin.from_m == 0 ? "all" : fmt::format("{:g}-{:g}", bin.from_m, bin.to_m);
    text += fmt::format("{:>7} {:>6} {:>7.3f} {:>7.2f} {:>11.2f} {:>8.2f}\n", range, bin.n,
                        static_cast<double>(bin.n_found) / bin.n, bin.centre_px, bin.difference_px,
                        bin.bias_px);
  }
  for (const auto& [widths, ap50, ap50_95] : score.sizes) {
    text += fmt::format("{:g} to {:g} px wide: AP50 {:.3f}, AP50:95 {:.3f}\n", widths.least_px,
                        widths.below_px, *ap50, ap50_95.value_or(0));
  }
  if (score.ap50) text += fmt::format("AP50 {:.3f}, AP50:95 {:.3f}\n", *score.ap50, *score.ap50_95);
  return text + fmt::format("{} false in {} empty pairs, {} beside targets\n", score.n_false,
                            score.n_empty, score.n_beside);
}

nlohmann::ordered_json TrialJson(const TrialScore& score) {
  nlohmann::ordered_json bins = nlohmann::ordered_json::array();
  for (const TrialScore::Bin& bin : score.bins) {
    nlohmann::ordered_json json = {{"n", bin.n},
                                   {"found", bin.n_found},
                                   {"centre_x_median_px", bin.centre_px},
                                   {"difference_median_px", bin.difference_px},
                                   {"bias_px", bin.bias_px}};
    if (bin.from_m > 0) json["range_m"] = {bin.from_m, bin.to_m};
    bins.push_back(json);
  }
  nlohmann::ordered_json sizes = nlohmann::ordered_json::array();
  for (const auto& [widths, ap50, ap50_95] : score.sizes) {
    sizes.push_back({{"width_px", {widths.least_px, widths.below_px}},
                     {"ap50", *ap50},
                     {"ap50_95", ap50_95.value_or(0)}});
  }
  return {{"ap50", score.ap50.value_or(0)},
          {"ap50_95", score.ap50_95.value_or(0)},
          {"sizes", sizes},
          {"bins", bins},
          {"empty_pairs", score.n_empty},
          {"false_in_empty", score.n_false},
          {"beside_targets", score.n_beside}};
}

std::string BoxNoiseText(const GeometricConfig& fitted) {
  return "box_noise: " + BoxNoiseJson(fitted).dump() + "\n";
}

void PutIntoCard(const std::filesystem::path& card, const std::string& command,
                 const TrialScore& score, const GeometricConfig& fitted) {
  DetectorCard content = ReadDetectorCard(card);
  content.box_noise = BoxNoiseJson(fitted);
  content.provenance["box_noise"] = {{"command", command}, {"trial", TrialJson(score)}};
  ReplaceFile(card, DetectorCardText(content));
}

void PutMinScoreIntoCard(const std::filesystem::path& card, const std::string& command,
                         double min_score) {
  DetectorCard content = ReadDetectorCard(card);
  content.min_score = min_score;
  content.box_noise = nullptr;
  content.provenance.erase("box_noise");
  content.provenance["min_score"] = command;
  ReplaceFile(card, DetectorCardText(content));
}

}  // namespace windhover
