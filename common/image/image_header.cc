#include "common/image/image_header.h"

#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "common/config/fields.h"

namespace windhover {
namespace {

constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 30;
constexpr std::int64_t kMaxPixels = std::int64_t{128} << 20;

struct Size {
  std::int64_t width_px, height_px;
};

std::uint32_t BigEndian(std::string_view bytes, std::size_t at, int n) {
  std::uint32_t value = 0;
  for (int i = 0; i < n; ++i) {
    value = value << 8 | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
  }
  return value;
}

std::optional<Size> PngSize(std::string_view bytes) {
  if (!bytes.starts_with("\x89PNG\r\n\x1a\n")) return {};
  if (bytes.size() < 24 || bytes.find("IEND") == bytes.npos) throw ConfigError("PNG is cut short");
  return Size{BigEndian(bytes, 16, 4), BigEndian(bytes, 20, 4)};
}

bool IsFrame(unsigned marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

// Segments up to the first scan; within scans 0xff is no marker unless it ends the image.
std::optional<Size> JpegSize(std::string_view bytes) {
  if (!bytes.starts_with("\xff\xd8\xff")) return {};
  std::optional<Size> size;
  for (std::size_t at = 2; at + 9 < bytes.size();) {
    if (BigEndian(bytes, at, 1) != 0xff) throw ConfigError("JPEG is broken");
    const std::uint32_t marker = BigEndian(bytes, at + 1, 1);
    if (marker == 0xff) {  // Filling.
      ++at;
      continue;
    }
    if (IsFrame(marker)) size = Size{BigEndian(bytes, at + 7, 2), BigEndian(bytes, at + 5, 2)};
    if (marker == 0xda) {
      if (bytes.find("\xff\xd9", at) == bytes.npos) throw ConfigError("JPEG is cut short");
      return size;
    }
    at += 2 + BigEndian(bytes, at + 2, 2);
  }
  throw ConfigError("JPEG is cut short");
}

std::int64_t NumberAfter(std::string_view bytes, std::string_view word) {
  const std::size_t at = bytes.find(word);
  std::int64_t value = 0;
  if (at != bytes.npos) {
    const char* begin = bytes.data() + at + word.size();
    std::from_chars(begin, bytes.data() + bytes.size(), value);
  }
  return value;
}

std::optional<Size> RadianceSize(std::string_view bytes) {
  if (!bytes.starts_with("#?")) return {};
  const std::string_view header = bytes.substr(0, 4096);
  const std::int64_t height_px = NumberAfter(header, "\n-Y ");
  const std::size_t at = header.find("\n-Y ");
  const std::string_view rest = at == header.npos ? "" : header.substr(at + 4);
  return Size{NumberAfter(rest.substr(0, 64), " +X "), height_px};
}

std::optional<Size> ExrSize(std::string_view bytes) {
  using namespace std::string_view_literals;
  if (!bytes.starts_with("\x76\x2f\x31\x01")) return {};
  constexpr std::string_view kName = "dataWindow\0box2i\0"sv;
  const std::size_t at = bytes.find(kName);
  std::int32_t box[4];
  if (at == bytes.npos || bytes.size() < at + kName.size() + 4 + sizeof box) {
    throw ConfigError("OpenEXR is cut short");
  }
  std::memcpy(box, bytes.data() + at + kName.size() + 4, sizeof box);
  return Size{std::int64_t{box[2]} - box[0] + 1, std::int64_t{box[3]} - box[1] + 1};
}

}  // namespace

void CheckImageHeader(std::string_view bytes) {
  std::optional<Size> size;
  for (const auto read : {PngSize, JpegSize, RadianceSize, ExrSize}) {
    if (!size) size = read(bytes);
  }
  if (!size) return;
  if (size->width_px <= 0 || size->height_px <= 0) throw ConfigError("image has no pixels");
  if (size->width_px > kMaxPixels / size->height_px) {
    throw ConfigError(
        fmt::format("image is larger than 128 Mpx ({}x{})", size->width_px, size->height_px));
  }
}

void CheckImageFile(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw ConfigError("no such image file");
  const std::uintmax_t n = std::filesystem::file_size(file, error);
  if (error || n == 0) throw ConfigError("image file is empty or cannot be read");
  if (n > kMaxBytes) throw ConfigError("image file is larger than 1 GiB");
  std::string bytes(n, '\0');
  std::ifstream(file, std::ios::binary).read(bytes.data(), static_cast<std::streamsize>(n));
  CheckImageHeader(bytes);
}

}  // namespace windhover
