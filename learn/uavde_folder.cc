#include "learn/uavde_folder.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "common/table/number_table.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

/// "2023-03-01-10-15-00042" is frame 42 of the flight "2023-03-01-10-15".
struct FrameName {
  std::string flight, digits;
  std::string Of(const char* side) const { return fmt::format("{}-{}-{}", flight, side, digits); }
};

std::optional<FrameName> FrameNameFrom(std::string line) {
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
  if (line.ends_with(".txt")) line.resize(line.size() - 4);
  const std::size_t dash = line.rfind('-');
  if (dash == std::string::npos || dash == 0 || dash + 1 == line.size()) return std::nullopt;
  if (line.size() - dash > 10 || line.find('/') != std::string::npos ||
      line.find_first_not_of("0123456789", dash + 1) != std::string::npos) {
    return std::nullopt;
  }
  return FrameName{line.substr(0, dash), line.substr(dash + 1)};
}

/// Distances by the name of the left image, from a table with a column `distance` behind the names.
std::map<std::string, double> DistancesFrom(const fs::path& file, FileFindings* findings) {
  std::map<std::string, double> distances;
  std::ifstream in(file);
  std::string text;
  if (!in || !std::getline(in, text)) {
    findings->Add("cannot be read");
    return distances;
  }
  const auto field = [&text](int column) {
    std::size_t begin = 0;
    for (; column > 0 && begin != std::string::npos; --column) begin = text.find(',', begin) + 1;
    std::string value = text.substr(begin, text.find(',', begin) - begin);
    while (!value.empty() && std::isspace(static_cast<unsigned char>(value.back()))) {
      value.pop_back();
    }
    return value;
  };
  const int n_columns = static_cast<int>(std::count(text.begin(), text.end(), ',')) + 1;
  int column = 1;
  while (column < n_columns && field(column) != "distance") ++column;
  if (column == n_columns) {
    findings->Add(1, fmt::format("must have a column 'distance' behind the names (found {:?})",
                                 text.substr(0, 60)));
    return distances;
  }
  for (int line = 2; std::getline(in, text); ++line) {
    if (text.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::string number = field(column);
    double distance_m = 0;
    const auto [end, error] =
        std::from_chars(number.data(), number.data() + number.size(), distance_m);
    if (std::count(text.begin(), text.end(), ',') + 1 != n_columns || error != std::errc() ||
        end != number.data() + number.size() || !std::isfinite(distance_m)) {
      findings->Add(line, fmt::format("must be {} columns with a finite distance (found {:?})",
                                      n_columns, text.substr(0, 60)));
      continue;
    }
    distances[field(0)] = distance_m;
  }
  return distances;
}

class SplitReader {
 public:
  SplitReader(const UavdeFolder& data, const fs::path& folder, const std::string& split)
      : data_(data),
        list_((folder / (split + "_no_prefix.txt")).string()),
        boxes_(folder / split /
               (data.boxes == UavdeBoxes::kDetected ? "inference/detected_labels" : "label")),
        annotations_(folder / split / "annotations.csv"),
        exact_(folder / split / "annotations_exact.csv"),
        findings_(list_) {}

  std::vector<StereoTuple> Read() {
    FileFindings of_distances(annotations_.string()), of_exact(exact_.string());
    const auto distances_m = DistancesFrom(annotations_, &of_distances);
    std::map<std::string, double> exact_m;
    if (fs::exists(exact_)) exact_m = DistancesFrom(exact_, &of_exact);
    of_distances.ThrowIfAny();
    of_exact.ThrowIfAny();
    std::ifstream in(list_);
    std::string text;
    for (int line = 1; std::getline(in, text); ++line) {
      if (text.find_first_not_of(" \t\r") == std::string::npos) continue;
      const auto name = FrameNameFrom(text);
      if (name) {
        Add(*name, line, distances_m, exact_m);
      } else {
        findings_.Add(line,
                      fmt::format("must be PREFIX-NUMBER.txt (found {:?})", text.substr(0, 60)));
      }
    }
    findings_.ThrowIfAny();
    std::stable_sort(tuples_.begin(), tuples_.end(), [](const auto& a, const auto& b) {
      return std::pair(a.flight, a.utime) < std::pair(b.flight, b.utime);
    });
    return std::move(tuples_);
  }

 private:
  void Add(const FrameName& name, int line, const std::map<std::string, double>& distances_m,
           const std::map<std::string, double>& exact_m) {
    const std::string image = name.Of("Left") + ".jpg";
    const auto distance = distances_m.find(image);
    if (distance == distances_m.end()) {
      findings_.Add(line, fmt::format("{} must have {}", annotations_.string(), image));
    }
    StereoTuple tuple;
    tuple.box.score = 1;
    const bool has_left = TakeBox(name.Of("Left"), &tuple.box.left, &tuple.box.score);
    const bool has_right = TakeBox(name.Of("Right"), &tuple.box.right, &tuple.box.score);
    if (!has_left || !has_right || distance == distances_m.end()) return;
    const auto exact = exact_m.find(image);
    tuple.range_m = distance->second;
    tuple.range_true_m = exact == exact_m.end() ? tuple.range_m : exact->second;
    tuple.flight =
        flights_.try_emplace(name.flight, static_cast<int>(flights_.size())).first->second;
    tuple.utime = std::llround(std::stoi(name.digits) * 1e6 / data_.frame_rate_hz);
    for (const std::string& fault : FaultsOf(tuple)) findings_.Add(line, fault);
    tuples_.push_back(tuple);
  }

  bool TakeBox(const std::string& name, image_box_t* box, double* score) {
    const std::string file = (boxes_ / (name + ".txt")).string();
    FileFindings of_file(file);
    const NumberTable table = ReadNumberTable(file, 5, /*more_allowed=*/true, &of_file);
    if (of_file.empty() && table.rows.empty()) of_file.Add("must have a row");
    findings_.Add(of_file);
    if (table.rows.empty()) return false;
    const auto area = [](const NumberTable::Row& row) { return row.values[3] * row.values[4]; };
    const NumberTable::Row& row =
        data_.boxes == UavdeBoxes::kDetected
            ? table.rows.back()
            : *std::max_element(table.rows.begin(), table.rows.end(),
                                [&](const auto& a, const auto& b) { return area(a) < area(b); });
    *box = BoxFromShares({row.values[1], row.values[2], row.values[3], row.values[4]},
                         data_.image_width_px, data_.image_height_px);
    if (row.values.size() > 5) *score = std::min(*score, row.values[5]);
    return true;
  }

  const UavdeFolder& data_;
  const std::string list_;
  const fs::path boxes_, annotations_, exact_;
  FileFindings findings_;
  std::map<std::string, int> flights_;
  std::vector<StereoTuple> tuples_;
};

}  // namespace

TupleSplits ReadUavdeTexts(const UavdeFolder& data) {
  const fs::path folder = fs::exists(data.folder / "data") ? data.folder / "data" : data.folder;
  std::map<std::string, std::vector<StereoTuple>> splits;
  for (const char* split : {"train", "val", "test"}) {
    if (!fs::exists(folder / (std::string(split) + "_no_prefix.txt"))) continue;
    splits[split] = SplitReader(data, folder, split).Read();
  }
  if (splits.empty()) {
    throw ConfigError(fmt::format(
        "{}: must have train_no_prefix.txt, val_no_prefix.txt or test_no_prefix.txt (found none)",
        folder.string()));
  }
  if (splits.size() == 1) return SplitAsThePaper(splits.begin()->second);
  return {splits["train"], splits["val"], splits["test"]};
}

}  // namespace windhover
