#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace windhover {

/// What the table has of one run.
struct RunRow {
  int point = 0;
  std::uint64_t seed = 0;
  std::string verdict = {};                         ///< pass | fail | invalid
  std::string reason = {};                          ///< Why it is invalid.
  std::vector<std::optional<double>> metrics = {};  ///< Those of the plan; none of an invalid run.

  bool valid() const { return verdict != "invalid"; }
};

/// Rows by point and seed.
using RunRows = std::map<std::pair<int, std::uint64_t>, RunRow>;

/// The file that every worker appends a line to when a run has ended, so that a sweep that is
/// killed at any moment has lost at most the runs that it was at.
class Journal {
 public:
  /// Opens or creates it. @throws std::runtime_error naming the file.
  explicit Journal(const std::filesystem::path& file);
  ~Journal();
  Journal(const Journal&) = delete;

  /// One write(2) at the end of the file, so that lines of several processes do not mix.
  /// @throws std::runtime_error if the disk is full.
  void Append(const RunRow& row) const;

 private:
  std::filesystem::path file_;
  int fd_;
};

/// Rows of a journal, none if there is no such file. Of several rows of one run the last counts; a
/// line that is not whole is left out.
RunRows ReadJournal(const std::filesystem::path& file);

/// Writes a journal anew, with whole lines only.
void WriteJournal(const std::filesystem::path& file, const RunRows& rows);

}  // namespace windhover
