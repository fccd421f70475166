#include "sim/recorder.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/bus/channels.h"
#include "common/bus/truth_channels.h"
#include "common/image/image_codecs.h"
#include "lcmtypes/stereo_frame_t.hpp"

namespace windhover {
namespace {

constexpr int kJpegQuality = 95;

image_t JpegFromImage(const image_t& image) {
  if (image.pixelformat == image_t::PIXEL_FORMAT_MJPEG) return image;
  const bool is_gray = image.pixelformat == image_t::PIXEL_FORMAT_GRAY;
  const int channels = is_gray ? 1 : 3;
  if (!is_gray && image.pixelformat != image_t::PIXEL_FORMAT_RGB) {
    throw std::runtime_error("--record jpeg: only GRAY and RGB images can be compressed");
  }
  if (image.width <= 0 || image.height <= 0 || image.row_stride / channels < image.width ||
      image.size != std::int64_t{image.row_stride} * image.height) {
    throw std::runtime_error(
        fmt::format("--record jpeg: an image of {} x {} pixels cannot have {} "
                    "rows of {} bytes in {} bytes",
                    image.width, image.height, image.height, image.row_stride, image.size));
  }
  // cv::Mat wants mutable bytes; only read here.
  auto* bytes = const_cast<std::uint8_t*>(image.data.data());
  const cv::Mat view(image.height, image.width, CV_8UC(channels), bytes,
                     static_cast<std::size_t>(image.row_stride));
  cv::Mat coded = view;
  if (!is_gray) cv::cvtColor(view, coded, cv::COLOR_RGB2BGR);
  image_t jpeg = image;
  Codecs().imencode(".jpg", coded, jpeg.data, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  jpeg.size = static_cast<std::int32_t>(jpeg.data.size());
  jpeg.row_stride = 0;
  jpeg.pixelformat = image_t::PIXEL_FORMAT_MJPEG;
  return jpeg;
}

// Shared memory goes with its process: the log holds the pixels themselves.
std::vector<std::uint8_t> RecordedFrame(MessageBytes bytes, RecordedPixels pixels,
                                        SharedFrameReader* frames) {
  stereo_frame_t frame = Decode<stereo_frame_t>(bytes);
  for (image_t* image : {&frame.left, &frame.right}) {
    frames->Fetch(image);
    if (pixels == RecordedPixels::kJpeg) *image = JpegFromImage(*image);
  }
  return Encode(frame);
}

}  // namespace

RecordedPixels RecordedPixelsFromName(const std::string& name) {
  if (name == "none") return RecordedPixels::kNone;
  if (name == "jpeg") return RecordedPixels::kJpeg;
  if (name == "raw") return RecordedPixels::kRaw;
  throw std::runtime_error(fmt::format("--record: none, jpeg or raw, not '{}'", name));
}

Recorder::Recorder(Bus& bus, const std::filesystem::path& file, const std::vector<int>& ids,
                   RecordedPixels pixels)
    : bus_(bus), log_(file), pixels_(pixels) {
  std::vector<int> sorted = ids;
  std::sort(sorted.begin(), sorted.end());
  Record(channel::kUavTruth);
  using ChannelOfId = std::string (*)(int);
  for (const ChannelOfId name :
       {channel::NavState, channel::Imu, channel::Uwb, channel::Stereo, channel::FrameDigest,
        channel::Annotation, channel::Detection, channel::Range, channel::VelocityCommand}) {
    if (name == ChannelOfId{channel::Stereo} && pixels == RecordedPixels::kNone) continue;
    for (const int id : sorted) Record(name(id));
  }
}

void Recorder::Record(const std::string& channel) {
  const std::size_t place = channels_.size();
  channels_.push_back({channel, LayoutCheckOf(channel),
                       TypeOnChannel(channel) == MessageLayout<stereo_frame_t>::kName});
  bus_.SubscribeBytes(
      channel, [this, place](const std::string&, MessageBytes bytes) { Keep(place, bytes); });
}

void Recorder::Keep(std::size_t place, MessageBytes bytes) {
  if (const LayoutCheck check = channels_[place].check) check(bytes);
  if (n_heard_ == heard_.size()) heard_.emplace_back();
  Heard& message = heard_[n_heard_++];
  message.place = place;
  message.bytes.assign(bytes.begin(), bytes.end());
}

void Recorder::Write(const Heard& message, Utime utime) {
  const Channel& channel = channels_[message.place];
  if (channel.has_frames) {
    log_.WriteBytes(channel.name, utime, RecordedFrame(message.bytes, pixels_, &shared_frames_));
  } else {
    log_.WriteBytes(channel.name, utime, message.bytes);
  }
}

void Recorder::WriteHeader(const run_header_t& header) {
  log_.Write(channel::kRunHeader, header.utime, header);
  log_.Flush();
}

void Recorder::WriteTick(const tick_t& tick) {
  if (tick.phase == tick_t::PHASE_RUN) {
    order_.resize(n_heard_);
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    // A channel has one publisher, whose order is kept.
    std::sort(order_.begin(), order_.end(), [this](std::size_t a, std::size_t b) {
      return std::pair(heard_[a].place, a) < std::pair(heard_[b].place, b);
    });
    for (const std::size_t i : order_) Write(heard_[i], tick.utime);
    bus_.InProcess() ? log_.FlushNowAndThen() : log_.Flush();
  }
  n_heard_ = 0;
}

void Recorder::WriteEnd(const run_end_t& end) {
  log_.Write(channel::kRunEnd, end.utime, end);
  log_.Flush();
}

}  // namespace windhover
