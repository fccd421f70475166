#include "common/card/card_node.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace windhover {
namespace {

constexpr double kMaxNumber = 1e6;
constexpr std::size_t kMaxText = 200;

// Where byte `at` of a text is, as compilers count.
std::string LineAndColumn(const std::string& text, std::size_t at) {
  const std::size_t end = std::min(at == 0 ? 0 : at - 1, text.size());
  const auto begin = text.begin(), stop = begin + static_cast<std::ptrdiff_t>(end);
  const std::size_t newline = text.rfind('\n', end == 0 ? 0 : end - 1);
  const bool on_first = newline == std::string::npos || newline >= end;
  return fmt::format("{}:{}", 1 + std::count(begin, stop, '\n'),
                     on_first ? end + 1 : end - newline);
}

}  // namespace

void CardNode::MustBe(const std::string& must, const std::string& found) const {
  throw ConfigError(fmt::format("{}: {}: must be {} (found {})", name_,
                                path_.empty() ? "the card" : path_, must, found));
}

CardNode CardNode::operator[](const std::string& key) const {
  RequireObject();
  const auto it = json_.find(key);
  const std::string path = path_.empty() ? key : path_ + "." + key;
  if (it == json_.end()) CardNode(json_, name_, path).MustBe("there", "nothing");
  return {*it, name_, path};
}

std::vector<CardNode> CardNode::Items(std::size_t most) const {
  if (!json_.is_array() || json_.empty() || json_.size() > most) {
    MustBe(fmt::format("a list of 1 to {}", most), Found());
  }
  std::vector<CardNode> items;
  for (std::size_t i = 0; i < json_.size(); ++i) {
    items.emplace_back(json_[i], name_, fmt::format("{}.{}", path_, i));
  }
  return items;
}

double CardNode::Number(double low, double high) const {
  const double value = json_.is_number() ? json_.get<double>() : NAN;
  if (!(value >= low && value <= high)) {
    MustBe(fmt::format("a number from {:g} to {:g}", low, high), Found());
  }
  return value;
}

std::vector<float> CardNode::Numbers(int n) const {
  const auto count = static_cast<std::size_t>(n);
  if (!json_.is_array() || json_.size() != count) {
    MustBe(fmt::format("{} numbers", count), Found());
  }
  std::vector<float> values;
  for (const CardNode& item : Items(count)) {
    values.push_back(static_cast<float>(item.Number(-kMaxNumber, kMaxNumber)));
  }
  return values;
}

std::string CardNode::Text() const {
  if (!json_.is_string()) MustBe("a word", Found());
  const auto& text = json_.get_ref<const std::string&>();
  if (text.empty() || text.size() > kMaxText) MustBe("a word", Found());
  return text;
}

void CardNode::AllowOnly(std::initializer_list<const char*> keys) const {
  RequireObject();
  for (const auto& [key, value] : json_.items()) {
    const bool known = std::any_of(keys.begin(), keys.end(),
                                   [&, &name = key](const char* one) { return name == one; });
    if (!known) MustBe(fmt::format("of {}", fmt::join(keys, ", ")), fmt::format("'{}'", key));
  }
}

void CardNode::RequireObject() const {
  if (!json_.is_object()) MustBe("an object", Found());
}

std::string CardNode::Found() const {
  if (json_.is_array()) return fmt::format("a list of {}", json_.size());
  if (json_.is_object()) return "an object";
  return fmt::format("'{}'", json_.dump());
}

CardNode::Json ParseCardJson(const std::string& text, const std::string& name) {
  try {
    return CardNode::Json::parse(text);
  } catch (const CardNode::Json::parse_error& error) {
    throw ConfigError(fmt::format("{}:{}: must be JSON, whole and readable", name,
                                  LineAndColumn(text, error.byte)));
  } catch (const CardNode::Json::exception&) {  // Such as numbers that are too large.
    throw ConfigError(fmt::format("{}: must be JSON with finite numbers", name));
  }
}

void CheckCardFormat(const CardNode& root, const char* format) {
  if (root["format"].json() != format) {
    root["format"].MustBe(fmt::format("'{}'", format), root["format"].json().dump());
  }
  root["version"].Number(1, 1);
}

std::string ReadCardText(const std::filesystem::path& file, std::uintmax_t max_bytes) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  std::ifstream in(file, std::ios::binary);
  if (error || !in) {
    throw ConfigError(fmt::format("{}: must be a file that can be read", file.string()));
  }
  if (bytes > max_bytes) {
    throw ConfigError(
        fmt::format("{}: must be at most {} bytes (found {})", file.string(), max_bytes, bytes));
  }
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace windhover
