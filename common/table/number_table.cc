#include "common/table/number_table.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/config/fields.h"

namespace windhover {
namespace {

constexpr std::size_t kMaxMessages = 20;
constexpr std::string_view kBlank = " \t\r\n";

std::string_view Trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

// At every comma or semicolon if there is one, else at runs of white space.
std::vector<std::string_view> SplitIntoFields(std::string_view line) {
  std::vector<std::string_view> fields;
  const bool separated = line.find_first_of(",;") != std::string_view::npos;
  const std::string_view separators = separated ? ",;" : kBlank;
  while (true) {
    const std::size_t end = line.find_first_of(separators);
    fields.push_back(Trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    line.remove_prefix(end + 1);
    if (!separated) line = Trimmed(line);
  }
}

std::optional<double> NumberFrom(std::string_view field) {
  if (field.starts_with('+')) field.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size()) return std::nullopt;
  return value;
}

// What is wrong with the row, or nothing if `*values` now holds it.
std::string ReadRow(const std::vector<std::string_view>& fields, int n_columns, bool more_allowed,
                    std::vector<double>* values) {
  const int n_fields = static_cast<int>(fields.size());
  if (n_fields < n_columns || (n_fields > n_columns && !more_allowed)) {
    return fmt::format("must have {} columns (found {})", n_columns, n_fields);
  }
  for (int i = 0; i < n_fields; ++i) {
    const auto value = NumberFrom(fields[i]);
    if (!value || !std::isfinite(*value)) {
      return fmt::format("column {}: must be a finite number (found '{}')", i + 1, fields[i]);
    }
    values->push_back(*value);
  }
  return "";
}

}  // namespace

void FileFindings::Keep(const std::string& message) {
  if (messages_.size() < kMaxMessages) messages_.push_back(message);
  ++count_;
}

void FileFindings::Add(int line, const std::string& what) {
  Keep(fmt::format("{}:{}: {}", file_, line, what));
}

void FileFindings::Add(const std::string& what) { Keep(fmt::format("{}: {}", file_, what)); }

void FileFindings::Add(const FileFindings& other) {
  for (const std::string& message : other.messages_) Keep(message);
  count_ += other.count_ - static_cast<int>(other.messages_.size());
}

void FileFindings::ThrowIfAny() const {
  if (empty()) return;
  std::string text = fmt::format("{}", fmt::join(messages_, "\n"));
  const int left_out = count_ - static_cast<int>(messages_.size());
  if (left_out > 0) text += fmt::format("\n{}: and {} more like these", file_, left_out);
  throw ConfigError(text);
}

NumberTable ReadNumberTable(const std::string& file, int n_columns, bool more_allowed,
                            FileFindings* findings) {
  NumberTable table;
  std::ifstream in(file);
  if (!in) {
    findings->Add("cannot be opened");
    return table;
  }
  std::string text;
  bool in_header = true;
  for (int line = 1; std::getline(in, text); ++line) {
    std::string_view rest = Trimmed(text);
    if (line == 1 && rest.starts_with("\xEF\xBB\xBF")) rest = Trimmed(rest.substr(3));
    if (rest.empty()) continue;
    const bool comment = rest.starts_with('#');
    const auto fields = SplitIntoFields(comment ? Trimmed(rest.substr(1)) : rest);
    if (comment || (in_header && table.header.empty() && !NumberFrom(fields[0]))) {
      if (in_header) table.header.assign(fields.begin(), fields.end());
      continue;
    }
    in_header = false;
    NumberTable::Row row{line, {}};
    // Rows may be longer than asked for, but must then all be alike.
    if (more_allowed && !table.rows.empty()) {
      n_columns = static_cast<int>(table.rows.front().values.size());
      more_allowed = false;
    }
    if (const auto problem = ReadRow(fields, n_columns, more_allowed, &row.values);
        problem.empty()) {
      table.rows.push_back(std::move(row));
    } else {
      findings->Add(line, problem);
    }
  }
  return table;
}

}  // namespace windhover
