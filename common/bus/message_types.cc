#include "common/bus/message_types.h"

#include <array>
#include <string_view>

#include "common/bus/channels.h"
#include "common/bus/truth_channels.h"
#include "lcmtypes/layouts.h"

namespace windhover {
namespace {

template <typename... Messages>
struct Fingerprints {
  static std::vector<type_fingerprint_t> List() {
    std::vector<type_fingerprint_t> list;
    (Add<Messages>(&list), ...);
    return list;
  }
  template <typename Message>
  static void Add(std::vector<type_fingerprint_t>* list) {
    type_fingerprint_t entry{};
    entry.name = MessageLayout<Message>::kName;
    entry.fingerprint = Message::getHash();
    list->push_back(entry);
  }
};

struct ChannelType {
  std::string_view name;  // Ends in '_': a prefix that an aircraft or a process completes.
  const char* type;
  LayoutCheck check;
};

template <typename Message>
constexpr ChannelType Entry(std::string_view name) {
  return {name, MessageLayout<Message>::kName, &CheckLayout<Message>};
}

constexpr std::array kChannelTypes = {
    Entry<tick_t>("TICK"),
    Entry<tick_done_t>("TICK_DONE"),
    Entry<hello_t>("HELLO"),
    Entry<status_t>("STATUS_"),
    Entry<run_header_t>("RUN_HEADER"),
    Entry<run_end_t>("RUN_END"),
    Entry<world_truth_t>("UAV_TRUTH"),
    Entry<nav_state_t>("NAV_STATE_"),
    Entry<imu_t>("IMU_"),
    Entry<uwb_t>("UWB_"),
    Entry<stereo_frame_t>("STEREO_"),
    Entry<frame_digest_t>("FRAME_DIGEST_"),
    Entry<annotation_t>("ANNOTATION_"),
    Entry<detection_t>("DETECTION_"),
    Entry<range_t>("RANGE_"),
    Entry<velocity_command_t>("VELOCITY_COMMAND_"),
    Entry<image_t>("IMAGE_LEFT_"),
    Entry<image_t>("IMAGE_RIGHT_"),
};

const ChannelType* Find(std::string_view channel) {
  for (const ChannelType& entry : kChannelTypes) {
    if (entry.name.ends_with('_') ? channel.starts_with(entry.name) : channel == entry.name) {
      return &entry;
    }
  }
  return nullptr;
}

}  // namespace

std::vector<type_fingerprint_t> AllFingerprints() { return WithAllMessages<Fingerprints>::List(); }

std::string TypeOnChannel(const std::string& channel) {
  const ChannelType* entry = Find(channel);
  return entry == nullptr ? "" : entry->type;
}

LayoutCheck LayoutCheckOf(const std::string& channel) {
  const ChannelType* entry = Find(channel);
  return entry == nullptr ? nullptr : entry->check;
}

void CheckChannelLayout(const std::string& channel, MessageBytes bytes) {
  if (const LayoutCheck check = LayoutCheckOf(channel)) check(bytes);
}

}  // namespace windhover
