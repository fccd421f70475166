#include "common/bus/shared_frames.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>

namespace windhover {
namespace {

constexpr std::size_t kHeadBytes = 64;  // Before the pixels of a slot; their time ends it.
constexpr std::size_t kMaxMappings = 64;

// Where an image's pixels are.
struct Place {
  int pid = 0, fd = 0;
  std::size_t offset = 0, size = 0;
  std::int64_t utime = 0;
};

[[noreturn]] void Fail(const std::string& what) {
  throw std::runtime_error(fmt::format("shared frame: {}", what));
}

const image_metadata_t* PlaceIn(const image_t& message) {
  const auto found = std::find_if(message.metadata.begin(), message.metadata.end(),
                                  [](const auto& entry) { return entry.key == kSharedFrameKey; });
  return found == message.metadata.end() ? nullptr : &*found;
}

Place ReadPlace(const image_metadata_t& entry) {
  std::istringstream text(std::string(entry.value.begin(), entry.value.end()));
  Place place;
  text >> place.pid >> place.fd >> place.offset >> place.size >> place.utime;
  if (!text || place.pid <= 0 || place.fd < 0 || place.offset < kHeadBytes) {
    Fail(fmt::format("'{}' is no place", text.str()));
  }
  return place;
}

}  // namespace

SharedFrameWriter::~SharedFrameWriter() {
  if (mapped_ != nullptr) munmap(mapped_, slot_bytes_ * kSharedFrameSlots);
}

void SharedFrameWriter::MakeRoomFor(std::size_t n_bytes) {
  if (kHeadBytes + n_bytes <= slot_bytes_) return;
  if (mapped_ != nullptr) munmap(mapped_, slot_bytes_ * kSharedFrameSlots);
  mapped_ = nullptr;
  slot_bytes_ = (kHeadBytes + n_bytes + 4095) / 4096 * 4096;
  const std::size_t size = slot_bytes_ * kSharedFrameSlots;
  memory_ = FileDescriptor(memfd_create("windhover-frames", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  // Sealed, so that readers cannot be left with a mapping of nothing.
  if (memory_.get() < 0 || ftruncate(memory_.get(), static_cast<off_t>(size)) != 0 ||
      fcntl(memory_.get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0) {
    Fail(fmt::format("no memory of {} bytes: {}", size, std::strerror(errno)));
  }
  void* mapped = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, memory_.get(), 0);
  if (mapped == MAP_FAILED) Fail(fmt::format("mmap: {}", std::strerror(errno)));
  mapped_ = static_cast<std::uint8_t*>(mapped);
}

std::vector<std::uint8_t> SharedFrameWriter::Share(image_t* message) {
  MakeRoomFor(message->data.size());
  const std::size_t offset = static_cast<std::size_t>(next_slot_) * slot_bytes_ + kHeadBytes;
  next_slot_ = (next_slot_ + 1) % kSharedFrameSlots;
  std::memcpy(mapped_ + offset - sizeof message->utime, &message->utime, sizeof message->utime);
  std::copy(message->data.begin(), message->data.end(), mapped_ + offset);
  image_metadata_t entry{};
  entry.key = kSharedFrameKey;
  const std::string place = fmt::format("{} {} {} {} {}", getpid(), memory_.get(), offset,
                                        message->data.size(), message->utime);
  entry.value.assign(place.begin(), place.end());
  entry.n = static_cast<std::int32_t>(entry.value.size());
  message->metadata.push_back(entry);
  message->nmetadata = static_cast<std::int32_t>(message->metadata.size());
  message->size = 0;
  return std::exchange(message->data, {});
}

SharedFrameReader::~SharedFrameReader() {
  for (const auto& [place, mapping] : mappings_) {
    munmap(const_cast<std::uint8_t*>(mapping.bytes), mapping.size);
  }
}

const SharedFrameReader::Mapping& SharedFrameReader::MappingOf(int pid, int fd) {
  const auto known = mappings_.find({pid, fd});
  if (known != mappings_.end()) return known->second;
  if (mappings_.size() >= kMaxMappings) Fail("too many senders");
  const std::string path = fmt::format("/proc/{}/fd/{}", pid, fd);
  // O_NONBLOCK: a pipe of this name must not hold us up.
  const FileDescriptor memory(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (memory.get() < 0 || fstat(memory.get(), &status) != 0) {
    Fail(fmt::format("{}: {}", path, std::strerror(errno)));
  }
  // Memory that could shrink could take this process down.
  const int seals = fcntl(memory.get(), F_GET_SEALS);
  if (seals < 0 || (seals & F_SEAL_SHRINK) == 0) Fail(path + " is not sealed memory");
  const auto size = static_cast<std::size_t>(status.st_size);
  void* mapped = mmap(nullptr, size, PROT_READ, MAP_SHARED, memory.get(), 0);
  if (mapped == MAP_FAILED) Fail(fmt::format("{}: {}", path, std::strerror(errno)));
  return mappings_[{pid, fd}] = {static_cast<const std::uint8_t*>(mapped), size};
}

std::span<const std::uint8_t> SharedFrameReader::PixelsOf(const image_t& message) {
  const image_metadata_t* entry = PlaceIn(message);
  if (entry == nullptr) return message.data;
  const Place place = ReadPlace(*entry);
  const Mapping& mapping = MappingOf(place.pid, place.fd);
  if (place.offset > mapping.size || place.size > mapping.size - place.offset) {
    Fail(fmt::format("{} bytes at {} of {}", place.size, place.offset, mapping.size));
  }
  std::int64_t utime = 0;
  std::memcpy(&utime, mapping.bytes + place.offset - sizeof utime, sizeof utime);
  if (utime != place.utime) Fail("its memory holds another image by now");
  return {mapping.bytes + place.offset, place.size};
}

void SharedFrameReader::Fetch(image_t* message) {
  const image_metadata_t* entry = PlaceIn(*message);
  if (entry == nullptr) return;
  const std::span<const std::uint8_t> pixels = PixelsOf(*message);
  message->data.assign(pixels.begin(), pixels.end());
  message->size = static_cast<std::int32_t>(pixels.size());
  message->metadata.erase(message->metadata.begin() + (entry - message->metadata.data()));
  message->nmetadata = static_cast<std::int32_t>(message->metadata.size());
}

}  // namespace windhover
