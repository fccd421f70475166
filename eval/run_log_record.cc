#include "eval/run_log_record.h"

#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "common/bus/channels.h"
#include "common/bus/run_log.h"
#include "common/bus/truth_channels.h"
#include "lcmtypes/run_end_t.hpp"
#include "lcmtypes/run_header_t.hpp"

namespace windhover {
namespace {

/// A flight while its log is being read.
class RecordBuilder {
 public:
  explicit RecordBuilder(const std::filesystem::path& log) : log_(log), reader_(log) {
    while (const auto event = reader_.Next()) Take(*event);
  }

  RunRecord Finish() && {
    if (!has_header_) {
      throw std::runtime_error(
          fmt::format("{}: there is no RUN_HEADER: not a log of windhover", log_.string()));
    }
    TakeUwb();
    const auto by_time = [](auto& a, auto& b) { return a.utime < b.utime; };
    std::stable_sort(record_.world.begin(), record_.world.end(), by_time);
    std::stable_sort(record_.commands.begin(), record_.commands.end(), by_time);
    for (auto& [key, frame] : frames_) record_.frames.push_back(std::move(frame));
    record_.invalid_reason = WhyInvalid();
    record_.valid = record_.invalid_reason.empty();
    return std::move(record_);
  }

 private:
  void Take(const LogEvent& event) {
    const std::string& on = event.channel;
    if (on == channel::kRunHeader) {
      TakeHeader(reader_.DecodeEvent<run_header_t>(event));
    } else if (on == channel::kRunEnd) {
      end_ = reader_.DecodeEvent<run_end_t>(event);
    } else if (on == channel::kUavTruth) {
      record_.world.push_back(reader_.DecodeEvent<world_truth_t>(event));
    } else if (on.starts_with("ANNOTATION_")) {
      auto truth = reader_.DecodeEvent<annotation_t>(event);
      ObserverFrame& frame = FrameOf(truth.utime, truth.observer_id);
      frame.truth = std::move(truth);
      ++n_annotated_;
    } else if (on.starts_with("DETECTION_")) {
      auto detections = reader_.DecodeEvent<detection_t>(event);
      ObserverFrame& frame = FrameOf(detections.utime, detections.observer_id);
      frame.detections = std::move(detections);
    } else if (on.starts_with("RANGE_")) {
      auto ranges = reader_.DecodeEvent<range_t>(event);
      ObserverFrame& frame = FrameOf(ranges.utime, ranges.observer_id);
      frame.ranges = std::move(ranges);
    } else if (on.starts_with("VELOCITY_COMMAND_")) {
      record_.commands.push_back(reader_.DecodeEvent<velocity_command_t>(event));
    } else if (on.starts_with("UWB_")) {
      uwb_.push_back(reader_.DecodeEvent<uwb_t>(event));
    }
  }

  void TakeHeader(const run_header_t& header) {
    record_.scenario = ScenarioFromYaml(header.resolved_yaml, log_.string() + " (RUN_HEADER)");
    record_.version = header.version;
    has_header_ = true;
  }

  ObserverFrame& FrameOf(Utime utime, int observer_id) {
    ObserverFrame& frame = frames_[{utime, observer_id}];
    frame.utime = utime;
    frame.observer_id = observer_id;
    return frame;
  }

  void TakeUwb() {
    for (const uwb_t& uwb : uwb_) {
      const auto frame = frames_.find({uwb.utime, uwb.id});
      if (frame == frames_.end()) continue;  // An aircraft without a rig.
      for (const uwb_range_t& range : uwb.ranges) {
        frame->second.uwb_m[range.target_id] = range.range_m;
      }
    }
  }

  std::string WhyInvalid() const {
    if (!reader_.Damage().empty()) {
      const LogDamage& first = reader_.Damage().front();
      return fmt::format("the log is damaged: {} bytes at byte {} cannot be read", first.n_bytes,
                         first.offset);
    }
    if (!end_) return "the log ends without RUN_END: the run was cut short";
    if (!end_->valid) return end_->reason.empty() ? "the run was called invalid" : end_->reason;
    const auto n_rigs =
        std::count_if(record_.scenario.aircraft.begin(), record_.scenario.aircraft.end(),
                      [](auto& aircraft) { return aircraft.self.carries_rig; });
    if (n_annotated_ == end_->n_ticks * n_rigs &&
        n_annotated_ == static_cast<std::int64_t>(record_.frames.size())) {
      return "";
    }
    return fmt::format("{} ticks of {} stereo rigs should have {} ANNOTATION messages (found {})",
                       end_->n_ticks, n_rigs, end_->n_ticks * n_rigs, n_annotated_);
  }

  std::filesystem::path log_;
  RunLogReader reader_;
  RunRecord record_;
  bool has_header_ = false;
  std::optional<run_end_t> end_;
  std::int64_t n_annotated_ = 0;
  std::map<std::pair<Utime, int>, ObserverFrame> frames_;
  std::vector<uwb_t> uwb_;
};

}  // namespace

RunRecord ReadRunRecord(const std::filesystem::path& log) { return RecordBuilder(log).Finish(); }

}  // namespace windhover
