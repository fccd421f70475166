#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/bus/bus.h"
#include "common/bus/message_types.h"
#include "common/bus/run_log.h"
#include "common/bus/shared_frames.h"
#include "lcmtypes/run_end_t.hpp"
#include "lcmtypes/run_header_t.hpp"
#include "lcmtypes/tick_t.hpp"

namespace windhover {

/// Which pixels the log keeps besides each frame's digest.
enum class RecordedPixels { kNone, kJpeg, kRaw };

/// "none", "jpeg" or "raw".
/// @throws std::runtime_error for anything else.
RecordedPixels RecordedPixelsFromName(const std::string& name);

/// Writes a run's log: RUN_HEADER, then what was said in each tick in one order (kind of channel,
/// id, order on the channel) whatever the order of arrival, then RUN_END. Every event of a tick
/// carries the tick's time.
///
/// Each tick is handed to the operating system: whatever becomes of this process, the log is whole
/// up to the tick before. Where all nodes are in one process, which end together, that is done now
/// and then (RunLogWriter::FlushNowAndThen): a process that is killed takes its last tenth of a
/// second with it, one that throws nothing.
class Recorder {
 public:
  /// Subscribes on `bus` to all that is recorded of the aircraft `ids`. Must live as long as `bus`
  /// is handled.
  Recorder(Bus& bus, const std::filesystem::path& file, const std::vector<int>& ids,
           RecordedPixels pixels);
  Recorder(const Recorder&) = delete;

  void WriteHeader(const run_header_t& header);
  /// Writes what has come since the last call; a rehearsal's messages are dropped. Call after
  /// Lockstep::Step(tick), which waits for all of them.
  void WriteTick(const tick_t& tick);
  void WriteEnd(const run_end_t& end);

 private:
  struct Channel {
    std::string name;
    LayoutCheck check;
    bool has_frames;
  };
  struct Heard {
    std::size_t place = 0;  // Of the channel in the canonical order.
    std::vector<std::uint8_t> bytes;
  };

  void Record(const std::string& channel);
  void Keep(std::size_t place, MessageBytes bytes);
  void Write(const Heard& message, Utime utime);

  Bus& bus_;
  RunLogWriter log_;
  RecordedPixels pixels_;
  SharedFrameReader shared_frames_;
  std::vector<Channel> channels_;  // In the canonical order.
  std::vector<Heard> heard_;       // The first n_heard_; the others keep their memory.
  std::size_t n_heard_ = 0;
  std::vector<std::size_t> order_;
};

}  // namespace windhover
