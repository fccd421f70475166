#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/file_descriptor.h"
#include "lcmtypes/image_t.hpp"

namespace windhover {

/// Key of the metadata entry of an image_t whose pixels are in shared memory. Its value is text:
/// "PID FD OFFSET SIZE UTIME". /proc/PID/fd/FD opens the memory (read only); the pixels are SIZE
/// bytes at OFFSET, and the eight bytes before them (little-endian) are UTIME for as long as the
/// pixels are those of this image.
inline constexpr char kSharedFrameKey[] = "windhover.shm";

/// Images that a writer keeps: two of a stereo pair, and the pair before.
inline constexpr int kSharedFrameSlots = 4;

/// Puts the pixels of one stereo camera into memory that other processes of this machine can read,
/// so that messages need not carry them. The memory has no name: it goes with the process.
class SharedFrameWriter {
 public:
  SharedFrameWriter() = default;
  ~SharedFrameWriter();
  SharedFrameWriter(const SharedFrameWriter&) = delete;

  /// Copies the pixels of `*message` there and leaves, in their place, the metadata that says
  /// where. @return the memory that they had. @throws std::runtime_error if there is none to share.
  std::vector<std::uint8_t> Share(image_t* message);

 private:
  void MakeRoomFor(std::size_t n_bytes);

  FileDescriptor memory_;
  std::uint8_t* mapped_ = nullptr;
  std::size_t slot_bytes_ = 0;
  int next_slot_ = 0;
};

/// Finds pixels, wherever they are.
class SharedFrameReader {
 public:
  SharedFrameReader() = default;
  ~SharedFrameReader();
  SharedFrameReader(const SharedFrameReader&) = delete;

  /// The bytes of `message`: its data, or the shared memory that it names.
  /// @throws std::runtime_error if what it names is no such memory, or holds a later image.
  std::span<const std::uint8_t> PixelsOf(const image_t& message);

  /// Puts shared pixels back into `*message`, as if they had travelled with it.
  void Fetch(image_t* message);

 private:
  struct Mapping {
    const std::uint8_t* bytes = nullptr;
    std::size_t size = 0;
  };
  const Mapping& MappingOf(int pid, int fd);

  std::map<std::pair<int, int>, Mapping> mappings_;  ///< By process and its descriptor.
};

}  // namespace windhover
