#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "lcmtypes/bounded_reader.h"

namespace windhover {

/// Bytes of one received message. Valid only inside the handler.
using MessageBytes = std::span<const std::uint8_t>;

/// @throws MalformedMessage unless `bytes` are exactly one well-formed Message.
template <typename Message>
void CheckLayout(MessageBytes bytes) {
  using Layout = MessageLayout<Message>;
  try {
    if (bytes.size() > Layout::kMaxBytes) {
      throw MalformedMessage(
          fmt::format("has {} bytes, more than {}", bytes.size(), Layout::kMaxBytes));
    }
    BoundedReader in(bytes);
    in.Fingerprint(static_cast<std::uint64_t>(Message::getHash()));
    Layout::Walk(in);
    in.End();
  } catch (const MalformedMessage& e) {
    throw MalformedMessage(fmt::format("not a well-formed {}: {}", Layout::kName, e.what()));
  }
}

/// Decodes into `message`, whose memory is used again from message to message.
/// @throws MalformedMessage unless `bytes` are exactly one well-formed Message.
template <typename Message>
void DecodeTo(MessageBytes bytes, Message* message) {
  CheckLayout<Message>(bytes);
  const int size = static_cast<int>(bytes.size());
  if (message->decode(bytes.data(), 0, size) != size) {
    throw MalformedMessage(fmt::format("{} cannot be decoded", MessageLayout<Message>::kName));
  }
}

/// The message that `bytes` hold; throws as DecodeTo() does.
template <typename Message>
Message Decode(MessageBytes bytes) {
  Message message{};
  DecodeTo(bytes, &message);
  return message;
}

/// Encodes into `bytes`, whose memory is used again from message to message.
/// @throws std::runtime_error if a vector's size differs from its count member, if a string
/// holds a NUL, or if the message is larger than receivers accept.
template <typename Message>
void EncodeTo(const Message& message, std::vector<std::uint8_t>* bytes) {
  using Layout = MessageLayout<Message>;
  Layout::CheckCounts(message);
  const int size = message.getEncodedSize();
  if (size < 0 || static_cast<std::size_t>(size) > Layout::kMaxBytes) {
    throw std::runtime_error(fmt::format("a {} of {} bytes is too large", Layout::kName, size));
  }
  bytes->resize(static_cast<std::size_t>(size));
  if (message.encode(bytes->data(), 0, size) != size) {
    throw std::runtime_error(fmt::format("a string in a {} holds a NUL", Layout::kName));
  }
}

/// The encoded message; throws as EncodeTo() does.
template <typename Message>
std::vector<std::uint8_t> Encode(const Message& message) {
  std::vector<std::uint8_t> bytes;
  EncodeTo(message, &bytes);
  return bytes;
}

}  // namespace windhover
