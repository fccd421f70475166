#include "learn/uavde_file.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <optional>

#include <fmt/format.h>

#include "common/config/fields.h"
#include "common/table/number_table.h"
#include "learn/numpy_pickle.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;
using Kind = PickleValue::Kind;

constexpr std::size_t kMostBytes = 16 << 20;  // UAVDE has 1 MB.

/// Numbers of an array, row by row, and its shape.
struct Numbers {
  std::vector<std::int64_t> shape;
  std::vector<double> values;
};

template <typename T>
std::vector<double> Widened(const std::string& bytes) {
  std::vector<T> narrow(bytes.size() / sizeof(T));
  std::memcpy(narrow.data(), bytes.data(), narrow.size() * sizeof(T));
  return {narrow.begin(), narrow.end()};
}

/// Nothing if `value` is no array of float32 or float64 of as many numbers as its shape says.
std::optional<Numbers> NumbersOf(const PickleValue* value) {
  if (value == nullptr) return std::nullopt;
  if (value->Is(Kind::kFloat)) return Numbers{{}, {value->number}};
  if (!value->Is(Kind::kArray) || !value->items[2]->Is(Kind::kBytes)) return std::nullopt;
  Numbers numbers;
  const std::string &type = value->items[1]->text, &bytes = value->items[2]->text;
  const std::size_t size = type == "<f4" ? 4 : type == "<f8" ? 8 : 0;
  if (size == 0) return std::nullopt;
  std::size_t n = 1;
  for (const PickleValue* extent : value->items[0]->items) {
    const std::int64_t most = static_cast<std::int64_t>(kMostBytes);
    if (!extent->Is(Kind::kInt) || extent->integer < 0 || extent->integer > most) {
      return std::nullopt;
    }
    numbers.shape.push_back(extent->integer);
    n *= static_cast<std::size_t>(extent->integer);
    if (n > kMostBytes) return std::nullopt;
  }
  if (n * size != bytes.size()) return std::nullopt;
  numbers.values = size == 4 ? Widened<float>(bytes) : Widened<double>(bytes);
  return numbers;
}

std::string ShapeText(const std::optional<Numbers>& numbers) {
  if (!numbers) return "none";
  std::string text;
  for (const std::int64_t extent : numbers->shape) {
    text += fmt::format("{}{}", text.empty() ? "" : " x ", extent);
  }
  return text.empty() ? "one number" : text;
}

/// x, y, w, h and confidence of the last row.
struct BestBox {
  ImageShares box;
  double confidence = 1;
};

std::optional<BestBox> BestOf(const std::optional<Numbers>& rows) {
  if (!rows || rows->shape.size() != 2) return std::nullopt;
  const std::int64_t columns = rows->shape[1];
  if (rows->shape[0] == 0 || columns < 5 || columns > 6) return std::nullopt;
  const double* last = rows->values.data() + rows->values.size() - columns;
  return BestBox{{last[1], last[2], last[3], last[4]}, columns == 6 ? last[5] : 1};
}

/// An entry's tuple; what is wrong with it goes to `faults`.
StereoTuple TupleOf(const PickleValue& entry, int width_px, int height_px,
                    std::vector<std::string>* faults) {
  StereoTuple tuple;
  if (!entry.Is(Kind::kDict)) {
    faults->push_back("must be a dictionary");
    return tuple;
  }
  double confidence = 1;
  for (const char* side : {"left", "right"}) {
    const auto rows = NumbersOf(entry.At(side));
    const auto best = BestOf(rows);
    if (!best) {
      faults->push_back(
          fmt::format("{}: must be rows of 5 or 6 floats (found {})", side, ShapeText(rows)));
      continue;
    }
    (side[0] == 'l' ? tuple.box.left : tuple.box.right) =
        BoxFromShares(best->box, width_px, height_px);
    confidence = std::min(confidence, best->confidence);
  }
  tuple.box.score = confidence;
  const auto range = NumbersOf(entry.At("dist"));
  if (!range || range->values.size() != 1) {
    faults->push_back(fmt::format("dist: must be one float (found {})", ShapeText(range)));
  } else {
    tuple.range_m = tuple.range_true_m = range->values[0];
  }
  if (faults->empty()) *faults = FaultsOf(tuple);
  return tuple;
}

std::string NameOf(const PickleValue& entry) {
  const PickleValue* id = entry.Is(Kind::kDict) ? entry.At("file_id") : nullptr;
  if (id == nullptr || !id->Is(Kind::kText)) return "";
  const std::string name = id->text.substr(0, std::min<std::size_t>(id->text.find('\n'), 60));
  return fmt::format(" ({:?})", name);
}

std::string Content(const fs::path& file) {
  std::error_code failed;
  const std::uintmax_t size = fs::file_size(file, failed);
  std::ifstream in(file, std::ios::binary);
  if (failed || !in || size == 0) {
    throw ConfigError(fmt::format("{}: cannot be read", file.string()));
  }
  if (size > kMostBytes) {
    throw ConfigError(
        fmt::format("{}: must be at most {} bytes (found {})", file.string(), kMostBytes, size));
  }
  std::string content(size, '\0');
  in.read(content.data(), static_cast<std::streamsize>(size));
  content.resize(static_cast<std::size_t>(in.gcount()));
  return content;
}

/// Where the pickle of the objects begins: behind the magic, version and header of a .npy file.
/// Source: NumPy's documentation of the format, numpy.lib.format.
std::size_t PickleBegin(const std::string& content, const fs::path& file) {
  const std::size_t length_bytes = content.size() > 6 && content[6] == 1 ? 2 : 4;
  std::size_t length = 0;
  const std::size_t text = 8 + length_bytes;
  if (content.starts_with("\x93NUMPY") && content.size() > text) {
    for (std::size_t i = length_bytes; i > 0; --i) {
      length = length << 8 | static_cast<unsigned char>(content[7 + i]);
    }
  }
  if (length == 0 || length >= content.size() - text) {
    throw ConfigError(fmt::format("{}: must be a .npy file of NumPy", file.string()));
  }
  const std::string_view header(content.data() + text, length);
  if (header.find("'descr': '|O'") == std::string_view::npos) {
    throw ConfigError(fmt::format("{}: must be a list of dictionaries, 'descr': '|O' (found {:?})",
                                  file.string(), header.substr(0, 100)));
  }
  return text + length;
}

}  // namespace

std::vector<StereoTuple> ReadUavdeFile(const fs::path& file, int image_width_px,
                                       int image_height_px) {
  const std::string content = Content(file);
  const std::size_t begin = PickleBegin(content, file);
  std::optional<NumpyPickle> pickle;
  try {
    pickle.emplace(std::string_view(content).substr(begin), begin);
  } catch (const std::runtime_error& error) {
    throw ConfigError(fmt::format("{}: {}", file.string(), error.what()));
  }
  const PickleValue& root = pickle->root();
  const PickleValue& list = root.Is(Kind::kArray) ? *root.items[2] : root;
  if (!list.Is(Kind::kList)) {
    throw ConfigError(fmt::format("{}: must be a list of dictionaries", file.string()));
  }
  FileFindings findings(file.string());
  std::vector<StereoTuple> tuples;
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    std::vector<std::string> faults;
    tuples.push_back(TupleOf(*list.items[i], image_width_px, image_height_px, &faults));
    for (const std::string& fault : faults) {
      findings.Add(fmt::format("entry {}{}: {}", i, NameOf(*list.items[i]), fault));
    }
  }
  findings.ThrowIfAny();
  return tuples;
}

TupleSplits ReadUavdeFolder(const fs::path& folder, int image_width_px, int image_height_px) {
  const auto read = [&](const char* name) {
    std::vector<StereoTuple> tuples = ReadUavdeFile(folder / name, image_width_px, image_height_px);
    if (!tuples.empty()) return tuples;
    throw ConfigError(fmt::format("{}: has no entries", (folder / name).string()));
  };
  return {read("train.npy"), read("val.npy"), read("test.npy")};
}

}  // namespace windhover
