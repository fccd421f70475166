#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/bus/bus.h"
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
  struct Heard {
    std::size_t place = 0;  // Of the channel in the canonical order.
    std::string channel;
    std::vector<std::uint8_t> bytes;
  };

  void Record(const std::string& channel);

  Bus& bus_;
  RunLogWriter log_;
  RecordedPixels pixels_;
  SharedFrameReader shared_frames_;
  std::size_t n_channels_ = 0;
  std::vector<Heard> heard_;
};

}  // namespace windhover
