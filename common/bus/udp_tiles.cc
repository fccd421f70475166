#include "common/bus/udp_tiles.h"

#include <algorithm>
#include <exception>
#include <random>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <lcm/lcm.h>
#include <poll.h>
#include <unistd.h>

#include "common/bus/udp_network.h"

namespace windhover {
namespace {

constexpr std::size_t kTileBytes = 60'000;  // One datagram with its headers: at most 65,507.
constexpr std::size_t kWindow = 2;
constexpr std::size_t kMaxMessageBytes = std::size_t{64} << 20;
constexpr std::size_t kMaxSenders = 256;
constexpr std::chrono::milliseconds kResendAfter{100};
constexpr std::chrono::milliseconds kAnnouncePeriod{250};
constexpr std::chrono::milliseconds kTimeToAnswer{500};
constexpr std::chrono::seconds kTimeToAcknowledge{30};
constexpr const char* kAckChannel = "TILE_ACK";
constexpr const char* kReaderChannel = "TILE_READER";

std::int32_t TileCount(std::size_t n_bytes) {
  return static_cast<std::int32_t>((n_bytes + kTileBytes - 1) / kTileBytes);
}

std::int64_t RandomId() {
  std::random_device device;
  const std::uint64_t high = device();
  return static_cast<std::int64_t>((high << 32 | device()) >> 1) | 1;  // Never 0.
}

MessageBytes BytesOf(const lcm_recv_buf_t* buffer) {
  const auto* data = static_cast<const std::uint8_t*>(buffer->data);
  return {data, std::min<std::size_t>(buffer->data_size, LCM_MAX_MESSAGE_SIZE)};
}

}  // namespace

// The message being sent: for each tile on its way, who has not acknowledged it yet.
struct UdpTiles::Outgoing {
  std::int64_t message = 0;
  std::map<std::int32_t, std::set<std::int64_t>> waiting;
};

UdpTiles::UdpTiles(const std::string& url)
    : lcm_(lcm_create(UdpmUrlOfNextPort(url).c_str()), lcm_destroy),
      self_(RandomId()),
      outgoing_(std::make_unique<Outgoing>()) {
  if (!lcm_ || lcm_get_fileno(lcm_.get()) < 0) {
    throw std::runtime_error(fmt::format("bus: cannot open '{}'", UdpmUrlOfNextPort(url)));
  }
  for (const auto& [channel, handler] :
       {std::pair{kAckChannel, &OnAckBytes}, std::pair{kReaderChannel, &OnReaderBytes}}) {
    lcm_subscription_set_queue_capacity(lcm_subscribe(lcm_.get(), channel, handler, this), 0);
  }
}

UdpTiles::~UdpTiles() = default;

bool UdpTiles::NeedsTiles(std::size_t n_bytes) { return n_bytes > kTileBytes; }

void UdpTiles::CheckedPublish(const std::string& channel, const std::vector<std::uint8_t>& bytes) {
  const auto size = static_cast<unsigned int>(bytes.size());
  if (lcm_publish(lcm_.get(), channel.c_str(), bytes.data(), size) == 0) return;
  throw std::runtime_error(fmt::format("bus: cannot publish on {}", channel));
}

// --- Sending -----------------------------------------------------------------------------------

void UdpTiles::AskForReaders(const std::string& channel) {
  if (!asked_.insert(channel).second) return;
  tile_reader_t question{};
  question.channel = channel;
  CheckedPublish(kReaderChannel, Encode(question));
  const auto until = Clock::now() + kTimeToAnswer;
  while (Clock::now() < until) WaitUntil(until);
}

void UdpTiles::SendTile(const std::string& channel, MessageBytes bytes, std::int32_t tile) {
  const std::size_t begin = static_cast<std::size_t>(tile) * kTileBytes;
  const MessageBytes part = bytes.subspan(begin, std::min(kTileBytes, bytes.size() - begin));
  tile_t message{};
  message.sender = self_;
  message.message = outgoing_->message;
  message.message_bytes = static_cast<std::int32_t>(bytes.size());
  message.tile = tile;
  message.n = static_cast<std::int32_t>(part.size());
  message.data.assign(part.begin(), part.end());
  CheckedPublish(TileChannel(channel), Encode(message));
}

void UdpTiles::Publish(const std::string& channel, MessageBytes bytes) {
  if (bytes.size() > kMaxMessageBytes) {
    throw std::runtime_error(
        fmt::format("bus: {} bytes on {} are too many", bytes.size(), channel));
  }
  AskForReaders(channel);
  std::set<std::int64_t> readers;
  for (const auto& [reader, pid] : readers_[channel]) readers.insert(reader);
  *outgoing_ = {.message = n_messages_++, .waiting = {}};
  std::int32_t next = 0;
  auto last_progress = Clock::now();
  auto last_sent = last_progress;
  while (next < TileCount(bytes.size()) || !outgoing_->waiting.empty()) {
    while (next < TileCount(bytes.size()) && outgoing_->waiting.size() < kWindow) {
      if (!readers.empty()) outgoing_->waiting[next] = readers;
      SendTile(channel, bytes, next++);
      last_sent = Clock::now();
    }
    if (outgoing_->waiting.empty()) continue;
    if (WaitUntil(last_sent + kResendAfter)) {
      last_progress = Clock::now();
    } else if (Clock::now() - last_progress > kTimeToAcknowledge) {
      const std::int64_t silent = *outgoing_->waiting.begin()->second.begin();
      throw std::runtime_error(fmt::format("bus: process {} reads {} but does not acknowledge it",
                                           readers_[channel][silent], channel));
    } else if (Clock::now() - last_sent >= kResendAfter) {
      for (const auto& [tile, who] : outgoing_->waiting) SendTile(channel, bytes, tile);
      last_sent = Clock::now();
    }
  }
}

void UdpTiles::OnAck(const tile_ack_t& ack) {
  if (ack.sender != self_ || ack.message != outgoing_->message) return;
  const auto tile = outgoing_->waiting.find(ack.tile);
  if (tile == outgoing_->waiting.end()) return;
  tile->second.erase(ack.reader);
  if (tile->second.empty()) outgoing_->waiting.erase(tile);
}

// --- Receiving ---------------------------------------------------------------------------------

void UdpTiles::Subscribe(const std::string& channel) {
  inputs_.push_back(std::make_unique<Input>(Input{this, channel}));
  lcm_subscription_set_queue_capacity(
      lcm_subscribe(lcm_.get(), TileChannel(channel).c_str(), &OnTileBytes, inputs_.back().get()),
      0);
  Announce(channel);
}

void UdpTiles::Acknowledge(const tile_t& tile) {
  tile_ack_t ack{};
  ack.reader = self_;
  ack.sender = tile.sender;
  ack.message = tile.message;
  ack.tile = tile.tile;
  CheckedPublish(kAckChannel, Encode(ack));
}

void UdpTiles::OnTile(const std::string& channel, const tile_t& tile) {
  const auto key = std::make_pair(channel, tile.sender);
  if (!incoming_.contains(key) && incoming_.size() >= kMaxSenders) incoming_.clear();
  Incoming& incoming = incoming_[key];
  if (tile.message < incoming.message) return;
  const auto size = static_cast<std::size_t>(std::max(tile.message_bytes, 0));
  if (size == 0 || size > kMaxMessageBytes) throw MalformedMessage("of an impossible size");
  if (tile.message > incoming.message) {
    incoming.message = tile.message;
    incoming.bytes.assign(size, 0);
    incoming.missing.clear();
    for (std::int32_t i = 0; i < TileCount(size); ++i) incoming.missing.insert(i);
  }
  if (incoming.missing.contains(tile.tile)) {
    const std::size_t begin = static_cast<std::size_t>(tile.tile) * kTileBytes;
    const std::size_t expected = std::min(kTileBytes, incoming.bytes.size() - begin);
    if (size != incoming.bytes.size() || tile.data.size() != expected) {
      throw MalformedMessage("a tile that does not fit its message");
    }
    std::copy(tile.data.begin(), tile.data.end(),
              incoming.bytes.begin() + static_cast<std::ptrdiff_t>(begin));
    incoming.missing.erase(tile.tile);
    Acknowledge(tile);
    if (incoming.missing.empty()) ready_.push_back({channel, std::exchange(incoming.bytes, {})});
    return;
  }
  Acknowledge(tile);  // A double: its acknowledgement came too late.
}

// --- Who reads what ----------------------------------------------------------------------------

void UdpTiles::Announce(const std::string& channel) {
  tile_reader_t reader{};
  reader.reader = self_;
  reader.pid = getpid();
  reader.channel = channel;
  CheckedPublish(kReaderChannel, Encode(reader));
}

void UdpTiles::AnnounceNowAndThen() {
  if (Clock::now() - last_announced_ < kAnnouncePeriod) return;
  last_announced_ = Clock::now();
  for (const auto& input : inputs_) Announce(input->channel);
}

void UdpTiles::OnReader(const tile_reader_t& reader) {
  if (reader.reader != 0) {
    // A bus that reads its own channel cannot acknowledge while it sends.
    if (reader.reader != self_) readers_[reader.channel][reader.reader] = reader.pid;
    return;
  }
  for (const auto& input : inputs_) {
    if (input->channel == reader.channel) Announce(input->channel);
  }
}

int UdpTiles::Socket() const { return lcm_get_fileno(lcm_.get()); }

bool UdpTiles::WaitUntil(Clock::time_point until) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now());
  pollfd readable{.fd = Socket(), .events = POLLIN, .revents = 0};
  if (poll(&readable, 1, std::max(0, static_cast<int>(left.count()))) <= 0) return false;
  lcm_handle(lcm_.get());
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  return true;
}

void UdpTiles::Receive() {
  while (WaitUntil(Clock::now())) {
  }
  AnnounceNowAndThen();
}

std::optional<UdpTiles::Message> UdpTiles::Take() {
  if (ready_.empty()) return std::nullopt;
  std::optional<Message> message = std::move(ready_.front());
  ready_.pop_front();
  return message;
}

// --- Called by LCM: nothing may be thrown through its C frames -----------------------------------

void UdpTiles::OnTileBytes(const lcm_recv_buf_t* buffer, const char*, void* user) noexcept {
  auto* input = static_cast<Input*>(user);
  try {
    input->tiles->OnTile(input->channel, Decode<tile_t>(BytesOf(buffer)));
  } catch (const std::exception& e) {
    input->tiles->error_ = std::make_exception_ptr(std::runtime_error(
        fmt::format("bus: a message on {} is {}", TileChannel(input->channel), e.what())));
  }
}

void UdpTiles::OnAckBytes(const lcm_recv_buf_t* buffer, const char*, void* user) noexcept {
  try {
    static_cast<UdpTiles*>(user)->OnAck(Decode<tile_ack_t>(BytesOf(buffer)));
  } catch (const std::exception&) {
    static_cast<UdpTiles*>(user)->error_ = std::current_exception();
  }
}

void UdpTiles::OnReaderBytes(const lcm_recv_buf_t* buffer, const char*, void* user) noexcept {
  try {
    static_cast<UdpTiles*>(user)->OnReader(Decode<tile_reader_t>(BytesOf(buffer)));
  } catch (const std::exception&) {
    static_cast<UdpTiles*>(user)->error_ = std::current_exception();
  }
}

}  // namespace windhover
