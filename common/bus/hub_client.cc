#include "common/bus/hub_client.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <re2/re2.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include "common/bus/tcpq_protocol.h"

namespace windhover {
namespace {

constexpr std::size_t kStagingBytes = 64 << 10;
constexpr std::size_t kBytesPerRead = 8 << 20;  // Then others have their turn.
constexpr std::size_t kMaxWantsEntries = 4096;  // Channel names are the clients' to invent.
constexpr std::size_t kMaxPatterns = 4096;
constexpr std::int64_t kPatternMemory = 1 << 20;
constexpr std::size_t kMessagesPerSend = 32;

std::string WireWord(std::size_t value) {
  const std::uint32_t word = htonl(static_cast<std::uint32_t>(value));
  std::string bytes(4, '\0');
  std::memcpy(bytes.data(), &word, 4);
  return bytes;
}

}  // namespace

HubClient::HubClient(FileDescriptor socket, std::uint16_t port)
    : socket_(std::move(socket)), port_(port) {
  const int on = 1;
  setsockopt(socket_.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  auto hello = std::make_shared<HubMessage>();
  hello->header = WireWord(tcpq::kServerMagic) + WireWord(tcpq::kVersion);
  Queue(std::move(hello));
  Expect(Field::kHello, 8);
}

HubClient::~HubClient() = default;

void HubClient::Expect(Field field, std::size_t n_bytes) {
  field_ = field;
  n_needed_ = n_bytes;
  n_have_ = 0;
  if (field != Field::kData) small_.resize(n_bytes);
}

std::uint32_t HubClient::Word(std::size_t offset) const {
  std::uint32_t word = 0;
  std::memcpy(&word, small_.data() + offset, 4);
  return ntohl(word);
}

std::string HubClient::Read(
    const std::function<void(std::shared_ptr<const HubMessage>)>& on_message) {
  on_message_ = &on_message;
  std::array<std::uint8_t, kStagingBytes> staging;
  const int on = 1;
  for (std::size_t n_read = 0; n_read < kBytesPerRead && error_.empty() && !paused;) {
    // Pixels go straight to where they stay.
    const bool direct = field_ == Field::kData && n_needed_ - n_have_ >= staging.size();
    std::uint8_t* to = direct ? message_->data.get() + n_have_ : staging.data();
    const std::size_t room = direct ? n_needed_ - n_have_ : staging.size();
    const ssize_t n = recv(socket_.get(), to, room, MSG_DONTWAIT);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN) break;
    if (n <= 0) {
      closed_ = true;
      break;
    }
    // liblcm sends a message in five pieces with Nagle's algorithm on: without an immediate
    // acknowledgement each message waits 40 ms. Linux forgets the option as it goes.
    setsockopt(socket_.get(), IPPROTO_TCP, TCP_QUICKACK, &on, sizeof on);
    n_read += static_cast<std::size_t>(n);
    if (direct) {
      n_have_ += static_cast<std::size_t>(n);
      if (n_have_ == n_needed_) OnField();
    } else {
      Consume(staging.data(), static_cast<std::size_t>(n));
    }
  }
  on_message_ = nullptr;
  return error_;
}

void HubClient::Consume(const std::uint8_t* bytes, std::size_t n_bytes) {
  while (n_bytes > 0 && error_.empty()) {
    const std::size_t n = std::min(n_bytes, n_needed_ - n_have_);
    std::uint8_t* to = field_ == Field::kData ? message_->data.get() : small_.data();
    std::memcpy(to + n_have_, bytes, n);
    n_have_ += n;
    bytes += n;
    n_bytes -= n;
    if (n_have_ == n_needed_) OnField();
  }
}

void HubClient::OnField() {
  switch (field_) {
    case Field::kHello:
      if (Word(0) != tcpq::kClientMagic || Word(4) != tcpq::kVersion) {
        error_ = "does not speak LCM's tcpq protocol";
      } else {
        Expect(Field::kHead, 8);
      }
      break;
    case Field::kHead:
      OnHead();
      break;
    case Field::kName:
      OnName();
      break;
    case Field::kSize:
      StartData(Word(0));
      break;
    case Field::kData:
      Publish();
      break;
  }
}

void HubClient::OnHead() {
  type_ = Word(0);
  const std::uint32_t length = Word(4);
  const std::size_t most =
      type_ == tcpq::kPublish ? tcpq::kMaxChannelBytes : tcpq::kMaxPatternBytes;
  if (type_ < tcpq::kPublish || type_ > tcpq::kUnsubscribe) {
    error_ = fmt::format("sent a message of unknown type {}", type_);
  } else if (length == 0 || length > most) {
    error_ = fmt::format("sent a channel name of {} bytes", length);
  } else {
    Expect(Field::kName, length);
  }
}

void HubClient::OnName() {
  const std::string name(small_.begin(), small_.end());
  if (type_ == tcpq::kPublish) {
    message_ = std::make_shared<HubMessage>();
    message_->channel = name;
    Expect(Field::kSize, 4);
    return;
  }
  type_ == tcpq::kSubscribe ? Subscribe(name) : Unsubscribe(name);
  Expect(Field::kHead, 8);
}

void HubClient::StartData(std::size_t size) {
  if (size > tcpq::kMaxDataBytes) {
    error_ = fmt::format("announced a message of {} bytes", size);
    return;
  }
  // Not zeroed: a size alone, without the bytes, costs no memory.
  message_->data = std::make_shared_for_overwrite<std::uint8_t[]>(std::max<std::size_t>(size, 1));
  message_->size = size;
  Expect(Field::kData, size);
  if (size == 0) Publish();
}

void HubClient::Publish() {
  HubMessage& message = *message_;
  const std::string& channel = message.channel;
  takes_part_ |= channel == "HELLO" || channel == "TICK" || channel == "TICK_DONE";
  message.header =
      WireWord(tcpq::kPublish) + WireWord(channel.size()) + channel + WireWord(message.size);
  Expect(Field::kHead, 8);
  (*on_message_)(std::move(message_));
}

void HubClient::Subscribe(const std::string& pattern) {
  if (patterns_.size() >= kMaxPatterns) {
    error_ = "has too many subscriptions";
    return;
  }
  re2::RE2::Options options(re2::RE2::Quiet);
  options.set_encoding(re2::RE2::Options::EncodingLatin1);
  options.set_max_mem(kPatternMemory);
  auto regex = std::make_unique<re2::RE2>(pattern, options);
  // LCM's clients filter what they get: too much is safe where RE2 cannot read a pattern.
  if (!regex->ok()) regex = std::make_unique<re2::RE2>("(?s).*", options);
  patterns_.emplace_back(pattern, std::move(regex));
  wants_.clear();
}

void HubClient::Unsubscribe(const std::string& pattern) {
  const auto found = std::find_if(patterns_.begin(), patterns_.end(),
                                  [&](const auto& entry) { return entry.first == pattern; });
  if (found != patterns_.end()) patterns_.erase(found);
  wants_.clear();
}

bool HubClient::Wants(const std::string& channel) {
  const auto known = wants_.find(channel);
  if (known != wants_.end()) return known->second;
  if (wants_.size() >= kMaxWantsEntries) wants_.clear();
  const bool wants = std::any_of(patterns_.begin(), patterns_.end(), [&](const auto& entry) {
    return re2::RE2::FullMatch(channel, *entry.second);
  });
  return wants_[channel] = wants;
}

void HubClient::Queue(std::shared_ptr<const HubMessage> message) {
  queued_bytes_ += message->WireBytes();
  queue_.push_back(std::move(message));
}

bool HubClient::Flush() {
  while (!queue_.empty()) {
    std::array<iovec, 2 * kMessagesPerSend> parts;
    std::size_t n_parts = 0;
    std::size_t skip = front_sent_;
    const auto add = [&](const void* bytes, std::size_t size) {
      const std::size_t skipped = std::min(skip, size);
      skip -= skipped;
      if (skipped == size) return;
      // sendmsg() only reads, but iovec is not const.
      auto* begin = static_cast<std::uint8_t*>(const_cast<void*>(bytes));
      parts[n_parts++] = {begin + skipped, size - skipped};
    };
    for (std::size_t i = 0; i < std::min(queue_.size(), kMessagesPerSend); ++i) {
      add(queue_[i]->header.data(), queue_[i]->header.size());
      add(queue_[i]->data.get(), queue_[i]->size);
    }
    msghdr message{};
    message.msg_iov = parts.data();
    message.msg_iovlen = n_parts;
    const ssize_t n = sendmsg(socket_.get(), &message, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno == EAGAIN;
    queued_bytes_ -= static_cast<std::size_t>(n);
    front_sent_ += static_cast<std::size_t>(n);
    while (!queue_.empty() && front_sent_ >= queue_.front()->WireBytes()) {
      front_sent_ -= queue_.front()->WireBytes();
      queue_.pop_front();
    }
  }
  return true;
}

}  // namespace windhover
