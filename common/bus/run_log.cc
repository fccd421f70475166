#include "common/bus/run_log.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "common/bus/message_types.h"

namespace windhover {
namespace {

// An event: sync word, event number (8), time stamp (8), length of the channel (4), length of the
// data (4), channel, data; big-endian. Source: LCM's eventlog.c.
constexpr std::string_view kSync = "\xED\xA1\xDA\x01";
constexpr std::int64_t kHeaderBytes = 28;
constexpr std::uint64_t kMaxChannelBytes = 255;
constexpr std::uint64_t kMaxDataBytes = 1 << 28;
constexpr std::int64_t kScanBytes = 1 << 20;
constexpr std::int64_t kWindowBytes = 1 << 16;

constexpr std::size_t kPendingBytes = 1 << 16;
constexpr std::chrono::milliseconds kPendingTime{100};

void AddBigEndian(std::uint64_t value, int n_bytes, std::string* bytes) {
  for (int shift = 8 * (n_bytes - 1); shift >= 0; shift -= 8) {
    *bytes += static_cast<char>(value >> shift & 0xff);
  }
}

std::uint64_t FromBigEndian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (const char c : bytes) value = value << 8 | static_cast<unsigned char>(c);
  return value;
}

struct Lengths {
  std::int64_t channel = 0;
  std::int64_t data = 0;
};

// What the header says, or nothing if no event has such a header.
std::optional<Lengths> LengthsIn(std::string_view header) {
  if (header.size() < kHeaderBytes || !header.starts_with(kSync)) return std::nullopt;
  const std::uint64_t channel = FromBigEndian(header.substr(20, 4));
  const std::uint64_t data = FromBigEndian(header.substr(24, 4));
  if (channel == 0 || channel > kMaxChannelBytes || data > kMaxDataBytes) return std::nullopt;
  return Lengths{static_cast<std::int64_t>(channel), static_cast<std::int64_t>(data)};
}

}  // namespace

RunLogWriter::RunLogWriter(const std::filesystem::path& file)
    : file_(file), out_(file, std::ios::binary) {
  if (!out_) {
    throw std::runtime_error(
        fmt::format("{}: cannot be created: {}", file.string(), std::strerror(errno)));
  }
}

void RunLogWriter::WriteBytes(const std::string& channel, Utime utime, MessageBytes bytes) {
  pending_ += kSync;
  AddBigEndian(static_cast<std::uint64_t>(n_events_++), 8, &pending_);
  AddBigEndian(static_cast<std::uint64_t>(utime), 8, &pending_);
  AddBigEndian(channel.size(), 4, &pending_);
  AddBigEndian(bytes.size(), 4, &pending_);
  pending_ += channel;
  pending_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (pending_.size() >= 2 * kPendingBytes) HandOver();
}

RunLogWriter::~RunLogWriter() { HandOver(); }

void RunLogWriter::HandOver() {
  out_.write(pending_.data(), std::ssize(pending_));
  pending_.clear();
}

void RunLogWriter::FlushNowAndThen() {
  const auto now = std::chrono::steady_clock::now();
  if (pending_.size() < kPendingBytes && now - flushed_at_ < kPendingTime) return;
  flushed_at_ = now;
  Flush();
}

void RunLogWriter::Flush() {
  HandOver();
  if (out_.flush()) return;
  throw std::runtime_error(
      fmt::format("{}: cannot be written: {}", file_.string(), std::strerror(errno)));
}

RunLogReader::RunLogReader(const std::filesystem::path& file)
    : file_(file), in_(file, std::ios::binary) {
  std::error_code error;
  size_ = static_cast<std::int64_t>(std::filesystem::file_size(file, error));
  if (!in_ || error) throw std::runtime_error(fmt::format("{}: cannot be read", file.string()));
}

std::string_view RunLogReader::BytesAt(std::int64_t offset, std::int64_t n_bytes) {
  n_bytes = std::min(n_bytes, size_ - offset);
  if (offset < window_offset_ || offset + n_bytes > window_offset_ + std::ssize(window_)) {
    window_.resize(
        static_cast<std::size_t>(std::min(std::max(n_bytes, kWindowBytes), size_ - offset)));
    window_offset_ = offset;
    in_.clear();
    in_.seekg(offset);
    in_.read(window_.data(), std::ssize(window_));
    window_.resize(static_cast<std::size_t>(in_.gcount()));
  }
  return std::string_view(window_).substr(static_cast<std::size_t>(offset - window_offset_),
                                          static_cast<std::size_t>(n_bytes));
}

bool RunLogReader::SyncAt(std::int64_t offset) { return BytesAt(offset, 4) == kSync; }

std::optional<LogEvent> RunLogReader::EventAt(std::int64_t offset) {
  const std::string_view header = BytesAt(offset, kHeaderBytes);
  const std::optional<Lengths> lengths = LengthsIn(header);
  const std::int64_t begin = offset + kHeaderBytes;
  if (!lengths || lengths->channel + lengths->data > size_ - begin) return std::nullopt;
  LogEvent event;
  event.number = static_cast<std::int64_t>(FromBigEndian(header.substr(4, 8)));
  event.utime = static_cast<Utime>(FromBigEndian(header.substr(12, 8)));
  const std::string_view content = BytesAt(begin, lengths->channel + lengths->data);
  if (std::ssize(content) != lengths->channel + lengths->data) return std::nullopt;
  event.channel = content.substr(0, static_cast<std::size_t>(lengths->channel));
  event.bytes.assign(content.begin() + lengths->channel, content.end());
  event.offset = offset;
  const std::int64_t end = begin + lengths->channel + lengths->data;
  if (!IsWhole(event, end)) return std::nullopt;
  position_ = end;
  return event;
}

bool RunLogReader::IsWhole(const LogEvent& event, std::int64_t end) {
  if (end == size_ || SyncAt(end)) return true;
  // What follows is damaged, or the length of this one is: its content decides.
  try {
    CheckChannelLayout(event.channel, event.bytes);
    return !TypeOnChannel(event.channel).empty();
  } catch (const MalformedMessage&) {
    return false;
  }
}

bool RunLogReader::CutShortAt(std::int64_t offset) {
  const std::string_view header = BytesAt(offset, kHeaderBytes);
  if (header.size() < kHeaderBytes) return kSync.starts_with(header.substr(0, kSync.size()));
  const std::optional<Lengths> lengths = LengthsIn(header);
  return lengths && kHeaderBytes + lengths->channel + lengths->data > size_ - offset;
}

std::int64_t RunLogReader::NextSync(std::int64_t from) {
  const std::int64_t overlap = std::ssize(kSync) - 1;
  for (; from < size_; from += kScanBytes - overlap) {
    const std::size_t found = BytesAt(from, kScanBytes).find(kSync);
    if (found != std::string_view::npos) return from + static_cast<std::int64_t>(found);
  }
  return size_;
}

std::optional<LogEvent> RunLogReader::Next() {
  const std::int64_t start = position_;
  std::int64_t offset = start;
  while (offset < size_) {
    std::optional<LogEvent> event = EventAt(offset);
    if (event && offset > start) damage_.push_back({start, offset - start});
    if (event) return event;
    offset = NextSync(offset + 1);
  }
  position_ = size_;
  if (start == size_) return std::nullopt;
  if (CutShortAt(start)) {
    truncated_bytes_ = size_ - start;
  } else {
    damage_.push_back({start, size_ - start});
  }
  return std::nullopt;
}

}  // namespace windhover
