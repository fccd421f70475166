#include "learn/tuple_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "common/table/number_table.h"

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

image_box_t BoxFrom(const double* values, double x_px, double y_px) {
  // A share of 1/2 is the image's middle, between its two middle pixels.
  const bool is_share = x_px != 1;
  image_box_t box{};
  box.x_px = values[0] * x_px - (is_share ? 0.5 : 0);
  box.y_px = values[1] * y_px - (is_share ? 0.5 : 0);
  box.w_px = values[2] * x_px;
  box.h_px = values[3] * y_px;
  return box;
}

void Check(const StereoTuple& tuple, int line, FileFindings* findings) {
  const image_box_t &left = tuple.box.left, &right = tuple.box.right;
  for (const double size : {left.w_px, left.h_px, right.w_px, right.h_px}) {
    if (size > 0) continue;
    findings->Add(line, fmt::format("sizes of boxes must be above 0 (found {:g})", size));
    break;
  }
  if (!(left.x_px > right.x_px)) {
    findings->Add(line, fmt::format("the left box must be right of the right one: are they the "
                                    "wrong way round? (found a disparity of {:g} px)",
                                    left.x_px - right.x_px));
  }
  if (!(tuple.range_m > 0)) {
    findings->Add(line, fmt::format("distance must be above 0 (found {:g})", tuple.range_m));
  }
}

StereoTuple OursFrom(const std::vector<double>& values) {
  StereoTuple tuple;
  tuple.flight = static_cast<int>(values[1]);
  tuple.utime = static_cast<Utime>(values[2]);
  tuple.box.left = BoxFrom(&values[3], 1, 1);
  tuple.box.right = BoxFrom(&values[7], 1, 1);
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

TupleSplits SplitAsThePaper(const std::vector<StereoTuple>& all) {
  const auto n = static_cast<std::ptrdiff_t>(all.size());
  const auto train = n * 2815 / 3895, val = n * (2815 + 541) / 3895;
  return {{all.begin(), all.begin() + train},
          {all.begin() + train, all.begin() + val},
          {all.begin() + val, all.end()}};
}

}  // namespace

void WriteTuples(const TupleSplits& tuples, const std::string& file) {
  std::ofstream out(file);
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
  if (!out.flush()) throw std::runtime_error("cannot write " + file);
}

TupleSplits ReadTuples(const std::string& file, int image_width_px, int image_height_px) {
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
      tuple.box.left = BoxFrom(&values[0], image_width_px, image_height_px);
      tuple.box.right = BoxFrom(&values[4], image_width_px, image_height_px);
      tuple.box.score = 1;
      tuple.range_m = tuple.range_true_m = values[8];
    } else {
      tuple = OursFrom(values);
      part = SplitOf(values[0], &splits);
    }
    Check(tuple, row.line, &findings);
    if (part == nullptr) {
      findings.Add(row.line, fmt::format("split must be 0, 1 or 2 (found {:g})", values[0]));
    } else {
      part->push_back(tuple);
    }
  }
  if (columns == kUavdeColumns) splits = SplitAsThePaper(uavde);
  if (findings.empty() && (splits.train.empty() || splits.val.empty() || splits.test.empty())) {
    findings.Add(
        fmt::format("must have tuples to learn from, to choose by and to report (found "
                    "{}, {} and {})",
                    splits.train.size(), splits.val.size(), splits.test.size()));
  }
  findings.ThrowIfAny();
  return splits;
}

}  // namespace windhover
