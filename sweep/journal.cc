#include "sweep/journal.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "common/file/whole_file.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

std::string LineOf(const RunRow& row) {
  Json values = Json::array();
  for (const auto& value : row.metrics) values.push_back(value ? Json(*value) : Json(nullptr));
  const Json json = {{"point", row.point},
                     {"seed", row.seed},
                     {"verdict", row.verdict},
                     {"reason", row.reason},
                     {"metrics", values}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::optional<RunRow> RowOfLine(const std::string& line) {
  const Json json = Json::parse(line, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || !json.contains("metrics")) return std::nullopt;
  RunRow row;
  row.point = json.value("point", 0);
  row.seed = json.value("seed", std::uint64_t{0});
  row.verdict = json.value("verdict", "");
  row.reason = json.value("reason", "");
  for (const Json& value : json["metrics"]) {
    row.metrics.push_back(value.is_number() ? std::optional(value.get<double>()) : std::nullopt);
  }
  return row;
}

[[noreturn]] void Fail(const std::filesystem::path& file) {
  throw std::runtime_error(
      fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
}

}  // namespace

Journal::Journal(const std::filesystem::path& file)
    : file_(file), fd_(open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644)) {
  if (fd_ < 0) Fail(file_);
}

Journal::~Journal() { close(fd_); }

void Journal::Append(const RunRow& row) const {
  const std::string line = LineOf(row);
  const ssize_t n = write(fd_, line.data(), line.size());
  if (n >= 0 && static_cast<std::size_t>(n) != line.size()) errno = ENOSPC;
  if (n < 0 || static_cast<std::size_t>(n) != line.size()) Fail(file_);
}

RunRows ReadJournal(const std::filesystem::path& file) {
  RunRows rows;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::optional<RunRow> row = RowOfLine(line);
    if (row) rows[{row->point, row->seed}] = std::move(*row);
  }
  return rows;
}

void WriteJournal(const std::filesystem::path& file, const RunRows& rows) {
  std::string text;
  for (const auto& [key, row] : rows) text += LineOf(row);
  ReplaceFile(file, text);
}

}  // namespace windhover
