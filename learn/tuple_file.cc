#include "learn/tuple_file.h"

#include <algorithm>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "common/config/fields.h"
#include "common/file/whole_file.h"
#include "common/table/number_table.h"
#include "learn/uavde_file.h"

namespace windhover {
namespace {

constexpr int kOurColumns = 13, kUavdeColumns = 9;

void WriteBox(const image_box_t& box, std::ostream* out) {
  *out << fmt::format(",{},{},{},{}", box.x_px, box.y_px, box.w_px, box.h_px);
}

// Nine columns if the first line of numbers has nine.
int ColumnsOf(const std::string& file) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    const auto commas =
        std::count_if(line.begin(), line.end(), [](char c) { return c == ',' || c == ';'; });
    return commas == kUavdeColumns - 1 ? kUavdeColumns : kOurColumns;
  }
  return kOurColumns;
}

image_box_t BoxFrom(const double* values) {
  image_box_t box{};
  box.x_px = values[0];
  box.y_px = values[1];
  box.w_px = values[2];
  box.h_px = values[3];
  return box;
}

ImageShares SharesFrom(const double* values) {
  return {values[0], values[1], values[2], values[3]};
}

StereoTuple OursFrom(const std::vector<double>& values) {
  StereoTuple tuple;
  tuple.flight = static_cast<int>(values[1]);
  tuple.utime = static_cast<Utime>(values[2]);
  tuple.box.left = BoxFrom(&values[3]);
  tuple.box.right = BoxFrom(&values[7]);
  tuple.box.score = 1;
  tuple.range_m = values[11];
  tuple.range_true_m = values[12];
  return tuple;
}

std::vector<StereoTuple>* SplitOf(double split, TupleSplits* splits) {
  return split == 0   ? &splits->train
         : split == 1 ? &splits->val
         : split == 2 ? &splits->test
                      : nullptr;
}

TupleSplits ReadTupleTable(const std::string& file, int image_width_px, int image_height_px) {
  FileFindings findings(file);
  const int columns = ColumnsOf(file);
  const NumberTable table = ReadNumberTable(file, columns, /*more_allowed=*/false, &findings);
  TupleSplits splits;
  std::vector<StereoTuple> uavde;
  for (const NumberTable::Row& row : table.rows) {
    const std::vector<double>& values = row.values;
    std::vector<StereoTuple>* part = &uavde;
    StereoTuple tuple;
    if (columns == kUavdeColumns) {
      tuple.box.left = BoxFromShares(SharesFrom(&values[0]), image_width_px, image_height_px);
      tuple.box.right = BoxFromShares(SharesFrom(&values[4]), image_width_px, image_height_px);
      tuple.box.score = 1;
      tuple.range_m = tuple.range_true_m = values[8];
    } else {
      tuple = OursFrom(values);
      part = SplitOf(values[0], &splits);
    }
    for (const std::string& fault : FaultsOf(tuple)) findings.Add(row.line, fault);
    if (part == nullptr) {
      findings.Add(row.line, fmt::format("split must be 0, 1 or 2 (found {:g})", values[0]));
    } else {
      part->push_back(tuple);
    }
  }
  if (columns == kUavdeColumns) splits = SplitAsThePaper(uavde);
  findings.ThrowIfAny();
  return splits;
}

}  // namespace

void WriteTuples(const TupleSplits& tuples, const std::string& file) {
  WholeFile whole(file);
  std::ostream& out = whole.out();
  out << kTupleColumns << '\n';
  int split = 0;
  for (const auto* part : {&tuples.train, &tuples.val, &tuples.test}) {
    for (const StereoTuple& tuple : *part) {
      out << fmt::format("{},{},{}", split, tuple.flight, tuple.utime);
      WriteBox(tuple.box.left, &out);
      WriteBox(tuple.box.right, &out);
      out << fmt::format(",{},{}\n", tuple.range_m, tuple.range_true_m);
    }
    ++split;
  }
  whole.Commit();
}

TupleSplits ReadTuples(const std::filesystem::path& file, int image_width_px, int image_height_px) {
  if (std::filesystem::is_directory(file)) {
    return ReadUavdeFolder(file, image_width_px, image_height_px);
  }
  const TupleSplits splits =
      file.extension() == ".npy"
          ? SplitAsThePaper(ReadUavdeFile(file, image_width_px, image_height_px))
          : ReadTupleTable(file, image_width_px, image_height_px);
  if (splits.train.empty() || splits.val.empty() || splits.test.empty()) {
    throw ConfigError(
        fmt::format("{}: must have tuples to learn from, to choose by and to report (found {}, {} "
                    "and {})",
                    file.string(), splits.train.size(), splits.val.size(), splits.test.size()));
  }
  return splits;
}

}  // namespace windhover
