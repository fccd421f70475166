#pragma once

#include <filesystem>
#include <fstream>
#include <string_view>

namespace windhover {

/// A file that is written beside its place and put there when it is whole, so that a reader never
/// sees half.
class WholeFile {
 public:
  /// @throws std::runtime_error naming the file and the reason if it cannot be created.
  explicit WholeFile(std::filesystem::path file);
  WholeFile(const WholeFile&) = delete;
  /// Removes what was not committed.
  ~WholeFile();

  std::ofstream& out() { return out_; }

  /// Puts it in its place. @throws std::runtime_error naming the file and the reason if not all of
  /// it could be written (the disk is full).
  void Commit();

 private:
  std::filesystem::path file_, aside_;
  std::ofstream out_;
};

/// The same for content that is at hand.
void ReplaceFile(const std::filesystem::path& file, std::string_view content);

}  // namespace windhover
