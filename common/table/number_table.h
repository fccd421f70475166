#pragma once

#include <string>
#include <vector>

namespace windhover {

/// What is wrong with one input file, line by line, to be reported all at once.
class FileFindings {
 public:
  explicit FileFindings(std::string file) : file_(std::move(file)) {}

  /// Notes that line `line` (from 1) is wrong; the first 20 are kept, the others counted.
  void Add(int line, const std::string& what);

  /// Notes something about the file as a whole.
  void Add(const std::string& what);

  /// Takes over what is wrong with another file.
  void Add(const FileFindings& other);

  bool empty() const { return count_ == 0; }

  /// @throws ConfigError with one `FILE:LINE: WHAT` a line, if anything was noted.
  void ThrowIfAny() const;

 private:
  void Keep(const std::string& message);

  std::string file_;
  std::vector<std::string> messages_;
  int count_ = 0;
};

/// A table of numbers in a text file.
struct NumberTable {
  struct Row {
    int line;  ///< In the file, from 1.
    std::vector<double> values;
  };
  std::vector<std::string> header;  ///< Column names above the first row; empty if none.
  std::vector<Row> rows;            ///< All of the same length, every value finite.
};

/// Reads rows of numbers separated by commas, semicolons or white space. Lines that start with
/// '#' and empty lines are skipped. A row that is not `n_columns` (or more, if `more_allowed`)
/// finite numbers goes to `findings` and is left out.
NumberTable ReadNumberTable(const std::string& file, int n_columns, bool more_allowed,
                            FileFindings* findings);

}  // namespace windhover
