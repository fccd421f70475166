#include "common/file/whole_file.h"

#include <cerrno>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

namespace windhover {
namespace {

[[noreturn]] void Fail(const std::filesystem::path& file, const std::error_code& error) {
  throw std::runtime_error(
      fmt::format("{}: cannot be written: {}", file.string(), error.message()));
}

std::error_code LastError() { return {errno == 0 ? EIO : errno, std::generic_category()}; }

}  // namespace

WholeFile::WholeFile(std::filesystem::path file)
    : file_(std::move(file)), aside_(file_.string() + fmt::format(".{}.part", getpid())) {
  errno = 0;
  out_.open(aside_, std::ios::binary);
  if (!out_) Fail(file_, LastError());
}

WholeFile::~WholeFile() {
  if (aside_.empty()) return;
  out_.close();
  std::error_code ignored;
  std::filesystem::remove(aside_, ignored);
}

void WholeFile::Commit() {
  if (out_) errno = 0;  // Else it says why what came before could not be written.
  out_.close();
  if (!out_) Fail(file_, LastError());
  std::error_code error;
  std::filesystem::rename(aside_, file_, error);
  if (error) Fail(file_, error);
  aside_.clear();
}

void ReplaceFile(const std::filesystem::path& file, std::string_view content) {
  WholeFile whole(file);
  whole.out().write(content.data(), static_cast<std::streamsize>(content.size()));
  whole.Commit();
}

}  // namespace windhover
