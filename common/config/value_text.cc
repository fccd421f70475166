#include "common/config/value_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <set>

namespace windhover {
namespace {

template <typename Number>
bool ReadNumber(const ConfigNode& node, Number& value) {
  if (!node.IsScalar() || node.quoted) return false;
  std::string_view text = node.scalar;
  if (text.starts_with('+')) text.remove_prefix(1);
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end;
}

// Words that need no quotes: they cannot be taken for a number, a comment or punctuation.
bool IsPlainWord(const std::string& text) {
  const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  const auto is_allowed = [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') ||
           std::string_view("_./-").find(c) != std::string_view::npos;
  };
  constexpr std::array kNulls = {"null", "Null", "NULL"};
  return !text.empty() && (is_letter(text[0]) || text[0] == '/') &&
         std::all_of(text.begin(), text.end(), is_allowed) &&
         std::find(kNulls.begin(), kNulls.end(), text) == kNulls.end();
}

}  // namespace

bool ReadValue(const ConfigNode& node, double& value) {
  if (node.IsScalar() && !node.quoted && (node.scalar == ".inf" || node.scalar == "-.inf")) {
    value = std::numeric_limits<double>::infinity();
    return true;
  }
  if (node.IsScalar() && !node.quoted && node.scalar == ".nan") {
    value = kUnset;
    return true;
  }
  return ReadNumber(node, value);
}

bool ReadValue(const ConfigNode& node, int& value) { return ReadNumber(node, value); }
bool ReadValue(const ConfigNode& node, std::uint64_t& value) { return ReadNumber(node, value); }

bool ReadValue(const ConfigNode& node, bool& value) {
  if (!node.IsScalar() || node.quoted) return false;
  value = node.scalar == "true";
  return value || node.scalar == "false";
}

bool ReadValue(const ConfigNode& node, std::string& value) {
  if (!node.IsScalar()) return false;
  value = node.scalar;
  return true;
}

bool ReadValue(const ConfigNode& node, std::vector<std::string>& value) {
  if (!node.IsList()) return false;
  value.clear();
  for (const ConfigNode& item : node.items) {
    if (!ReadValue(item, value.emplace_back())) return false;
  }
  return true;
}

bool ReadValue(const ConfigNode& node, InputFile& value) {
  value = {};
  if (!ReadValue(node, value.as_given)) return false;
  value.where = node.where.ToString();
  if (value.empty()) return true;
  const std::filesystem::path file = node.where.source->folder / value.as_given;
  value.absolute = std::filesystem::absolute(file).lexically_normal().string();
  return true;
}

std::string WriteValue(double value) { return fmt::format("{}", value); }
std::string WriteValue(int value) { return fmt::format("{}", value); }
std::string WriteValue(std::uint64_t value) { return fmt::format("{}", value); }
std::string WriteValue(bool value) { return value ? "true" : "false"; }

std::string WriteValue(const std::string& value) {
  if (IsPlainWord(value)) return value;
  std::string text = "\"";
  for (const char c : value) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      text += fmt::format("\\{}", c);
    } else if (byte < 0x20 || byte == 0x7f) {
      text += fmt::format("\\x{:02x}", byte);
    } else {
      text += c;
    }
  }
  return text + "\"";
}

std::string WriteValue(const std::vector<std::string>& value) {
  std::string text;
  for (const std::string& item : value) text += (text.empty() ? "" : ", ") + WriteValue(item);
  return "[" + text + "]";
}

std::string Described(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  }
  return text;
}

std::string Described(const std::string&, const OneOf& limit) { return Described(limit.values); }
std::string Expected(const std::string&, const OneOf& limit) {
  return limit.values.size() == 1 ? limit.values[0] : "one of " + Described(limit.values);
}
bool Allows(const OneOf& limit, const std::string& value) {
  return std::find(limit.values.begin(), limit.values.end(), value) != limit.values.end();
}

std::string Described(const std::vector<std::string>&, const ItemsOneOf& limit) {
  return Described(limit.values);
}
std::string Expected(const std::vector<std::string>&, const ItemsOneOf& limit) {
  return "a list of at least one of " + Described(limit.values) + ", each once";
}
bool Allows(const ItemsOneOf& limit, const std::vector<std::string>& value) {
  const std::set<std::string> distinct(value.begin(), value.end());
  return !value.empty() && distinct.size() == value.size() &&
         std::all_of(value.begin(), value.end(),
                     [&](const std::string& item) { return Allows(OneOf{limit.values}, item); });
}

}  // namespace windhover
