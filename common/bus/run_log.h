#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/codec.h"
#include "common/time/sim_time.h"

namespace windhover {

/// Writes a log that lcm-logplayer and every other LCM tool reads. The same events give the same
/// bytes: time stamps are simulated.
class RunLogWriter {
 public:
  /// @throws std::runtime_error if the file cannot be created.
  explicit RunLogWriter(const std::filesystem::path& file);
  ~RunLogWriter();
  RunLogWriter(const RunLogWriter&) = delete;

  void WriteBytes(const std::string& channel, Utime utime, MessageBytes bytes);

  template <typename Message>
  void Write(const std::string& channel, Utime utime, const Message& message) {
    WriteBytes(channel, utime, Encode(message));
  }

  /// Hands what was written to the operating system, so that a killed run leaves a readable log.
  /// @throws std::runtime_error if anything could not be written (the disk is full).
  void Flush();

  /// The same, once 64 KiB or a tenth of a second (of the wall clock; what is written does not
  /// depend on it) have come together.
  void FlushNowAndThen();

 private:
  void HandOver();

  std::filesystem::path file_;
  std::ofstream out_;
  std::string pending_;  ///< Whole events.
  std::chrono::steady_clock::time_point flushed_at_ = std::chrono::steady_clock::now();
  std::int64_t n_events_ = 0;
};

/// One message in a log.
struct LogEvent {
  std::int64_t number = 0;  ///< As written; counts from 0.
  Utime utime = 0;
  std::string channel;
  std::vector<std::uint8_t> bytes;
  std::int64_t offset = 0;  ///< Of the event in the file.
};

/// A part of a log that could not be read.
struct LogDamage {
  std::int64_t offset = 0;
  std::int64_t n_bytes = 0;
};

/// Reads an LCM log from the first event to the last, past damaged parts.
///
/// An event counts as whole if another one or the end of the file follows it, or if its bytes
/// are a well-formed message of its channel. After anything else, reading goes on at the next
/// sync word that begins a whole event.
class RunLogReader {
 public:
  /// @throws std::runtime_error if the file cannot be read.
  explicit RunLogReader(const std::filesystem::path& file);

  /// The next whole event; nothing at the end.
  std::optional<LogEvent> Next();

  /// The message of an event.
  /// @throws std::runtime_error `file: event n at byte o: CHANNEL is …` if it is malformed.
  template <typename Message>
  Message DecodeEvent(const LogEvent& event) const {
    try {
      return Decode<Message>(event.bytes);
    } catch (const MalformedMessage& e) {
      throw std::runtime_error(fmt::format("{}: event {} at byte {}: {} is {}", file_.string(),
                                           event.number, event.offset, event.channel, e.what()));
    }
  }

  /// The damaged parts passed so far.
  const std::vector<LogDamage>& Damage() const { return damage_; }

  /// Bytes of an unfinished event at the end, as a run that was killed leaves them; harmless.
  std::int64_t TruncatedBytes() const { return truncated_bytes_; }

 private:
  std::optional<LogEvent> EventAt(std::int64_t offset);
  bool SyncAt(std::int64_t offset);
  bool CutShortAt(std::int64_t offset);
  bool IsWhole(const LogEvent& event, std::int64_t end);
  std::int64_t NextSync(std::int64_t from);
  /// Fewer at the end of the file; valid until the next call.
  std::string_view BytesAt(std::int64_t offset, std::int64_t n_bytes);

  std::filesystem::path file_;
  std::ifstream in_;
  std::int64_t size_ = 0;
  std::int64_t position_ = 0;
  std::string window_;  ///< Of the file, from window_offset_ on: the next events are in it.
  std::int64_t window_offset_ = 0;
  std::vector<LogDamage> damage_;
  std::int64_t truncated_bytes_ = 0;
};

}  // namespace windhover
