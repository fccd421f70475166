#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

namespace windhover {

/// How a message of type M is laid out. Specialised for each message by its generated header:
///
///     static constexpr const char* kName;      // "range_t"
///     static constexpr std::size_t kMinBytes;  // encoded without fingerprint, arrays empty
///     static constexpr std::size_t kMaxBytes;  // most that is accepted, with fingerprint
///     static void Walk(BoundedReader& in);     // every count and string, nothing decoded
///     static void CheckCounts(const M& m);     // array sizes against their count members
template <typename Message>
struct MessageLayout;

/// Bytes that are not a well-formed message of the expected type; what() says why.
class MalformedMessage : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Walks over an encoded message without decoding it and without reading past its end.
///
/// lcm-gen's decoders resize their vectors to whatever count the bytes name and compare
/// `8 * count` in 32 bits, so they must never see bytes that this reader has not passed.
class BoundedReader {
 public:
  explicit BoundedReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  std::size_t remaining() const { return rest_.size(); }

  /// @throws MalformedMessage unless the next 8 bytes are `expected`.
  void Fingerprint(std::uint64_t expected) {
    Need(8, "fingerprint");
    const std::uint64_t found = BigEndian(8);
    Drop(8);
    if (found == expected) return;
    throw MalformedMessage(fmt::format(
        "fingerprint is {:#018x}, expected {:#018x} (sender and receiver were built from "
        "different .lcm files, or this is another type)",
        found, expected));
  }

  void Skip(std::size_t n_bytes, const char* member) {
    Need(n_bytes, member);
    Drop(n_bytes);
  }

  /// The value of an int32_t that counts elements.
  /// @throws MalformedMessage if it is negative.
  std::size_t Count(const char* member) {
    Need(4, member);
    const auto value = static_cast<std::int32_t>(BigEndian(4));
    Drop(4);
    if (value < 0) throw MalformedMessage(fmt::format("{} is {}", member, value));
    return static_cast<std::size_t>(value);
  }

  /// `count` elements of at least `element_bytes` each must still be there.
  void Room(std::size_t count, std::size_t element_bytes, const char* member) const {
    // count < 2^31 and element_bytes is small, so the product fits 64 bits.
    if (count * element_bytes <= rest_.size()) return;
    throw MalformedMessage(fmt::format("{} has {} elements, which need {} bytes; {} are left",
                                       member, count, count * element_bytes, rest_.size()));
  }

  void SkipArray(std::size_t count, std::size_t element_bytes, const char* member) {
    Room(count, element_bytes, member);
    Drop(count * element_bytes);
  }

  /// LCM writes a string as its length with the closing NUL, then its bytes.
  void SkipString(const char* member) {
    const std::size_t length = Count(member);
    if (length == 0) throw MalformedMessage(fmt::format("{} is a string of length 0", member));
    Room(length, 1, member);
    if (std::memchr(rest_.data(), 0, length) != rest_.data() + length - 1) {
      throw MalformedMessage(fmt::format("{} is not closed by its first NUL", member));
    }
    Drop(length);
  }

  /// @throws MalformedMessage if bytes are left over.
  void End() const {
    if (!rest_.empty()) throw MalformedMessage(fmt::format("{} bytes too many", rest_.size()));
  }

 private:
  void Need(std::size_t n_bytes, const char* member) const {
    if (rest_.size() >= n_bytes) return;
    throw MalformedMessage(fmt::format("ends inside {}", member));
  }
  void Drop(std::size_t n_bytes) { rest_ = rest_.subspan(n_bytes); }
  std::uint64_t BigEndian(std::size_t n_bytes) const {
    std::uint64_t value = 0;
    for (const std::uint8_t byte : rest_.first(n_bytes)) value = value << 8 | byte;
    return value;
  }

  std::span<const std::uint8_t> rest_;
};

/// Generated encoders read `count` elements whatever the vector's size.
/// @throws std::runtime_error if the two differ.
inline void RequireCount(const char* member, std::int64_t count, std::size_t size) {
  if (count == static_cast<std::int64_t>(size)) return;
  throw std::runtime_error(
      fmt::format("{} has {} elements, but its count member says {}", member, size, count));
}

}  // namespace windhover
