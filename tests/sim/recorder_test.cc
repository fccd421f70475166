#include "sim/recorder.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "common/bus/channels.h"
#include "common/bus/truth_channels.h"
#include "lcmtypes/imu_t.hpp"
#include "lcmtypes/nav_state_t.hpp"
#include "lcmtypes/stereo_frame_t.hpp"
#include "lcmtypes/velocity_command_t.hpp"
#include "lcmtypes/world_truth_t.hpp"

namespace windhover {
namespace {

using testing::ElementsAre;

std::filesystem::path LogFile(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / ("windhover_" + name + ".lcm");
}

std::string BytesOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<LogEvent> EventsOf(const std::filesystem::path& file) {
  RunLogReader reader(file);
  std::vector<LogEvent> events;
  while (auto event = reader.Next()) events.push_back(*event);
  return events;
}

tick_t TickAt(std::int64_t utime, std::int8_t phase = tick_t::PHASE_RUN) {
  tick_t tick{};
  tick.utime = utime;
  tick.phase = phase;
  return tick;
}

imu_t ImuAt(std::int64_t utime) {
  imu_t imu{};
  imu.utime = utime;
  return imu;
}

// Ids 2 and 10: in numerical order, which is not that of their names.
void WriteOneTick(const std::filesystem::path& file, const std::vector<int>& order) {
  Bus bus("memq://");
  Recorder recorder(bus, file, {10, 2}, RecordedPixels::kNone);
  const std::vector<std::function<void()>> say = {
      [&] { bus.Publish(channel::VelocityCommand(2), velocity_command_t{}); },
      [&] { bus.Publish(channel::NavState(10), nav_state_t{}); },
      [&] { bus.Publish(channel::NavState(2), nav_state_t{}); },
      [&] { bus.Publish(channel::kUavTruth, world_truth_t{}); },
      [&] {
        bus.Publish(channel::Imu(2), ImuAt(10));
        bus.Publish(channel::Imu(2), ImuAt(15));
      },
  };
  recorder.WriteHeader(run_header_t{});
  for (const int what : order) say[static_cast<std::size_t>(what)]();
  while (bus.Handle(0)) continue;
  recorder.WriteTick(TickAt(20));
  recorder.WriteEnd(run_end_t{});
}

TEST(Recorder, WritesOneOrderWhateverTheOrderOfArrival) {
  std::vector<int> order = {0, 1, 2, 3, 4};
  WriteOneTick(LogFile("recorder_first"), order);
  const std::string expected = BytesOf(LogFile("recorder_first"));
  ASSERT_FALSE(expected.empty());
  do {
    WriteOneTick(LogFile("recorder_other"), order);
    ASSERT_EQ(BytesOf(LogFile("recorder_other")), expected);
  } while (std::next_permutation(order.begin(), order.end()));

  std::vector<std::string> channels;
  for (const LogEvent& event : EventsOf(LogFile("recorder_first"))) {
    channels.push_back(event.channel);
  }
  EXPECT_THAT(channels, ElementsAre("RUN_HEADER", "UAV_TRUTH", "NAV_STATE_2", "NAV_STATE_10",
                                    "IMU_2", "IMU_2", "VELOCITY_COMMAND_2", "RUN_END"));
}

TEST(Recorder, KeepsTheOrderOnAChannelAndStampsTheTick) {
  WriteOneTick(LogFile("recorder_order"), {4, 3, 2, 1, 0});
  RunLogReader reader(LogFile("recorder_order"));
  std::vector<std::int64_t> imu_times;
  while (auto event = reader.Next()) {
    if (event->channel != "IMU_2") continue;
    EXPECT_EQ(event->utime, 20);
    imu_times.push_back(reader.DecodeEvent<imu_t>(*event).utime);
  }
  EXPECT_THAT(imu_times, ElementsAre(10, 15));
}

TEST(Recorder, DropsTheRehearsal) {
  const auto file = LogFile("recorder_rehearsal");
  Bus bus("memq://");
  Recorder recorder(bus, file, {0}, RecordedPixels::kRaw);
  bus.Publish(channel::NavState(0), nav_state_t{});
  while (bus.Handle(0)) continue;
  recorder.WriteTick(TickAt(-1, tick_t::PHASE_REHEARSAL));
  recorder.WriteTick(TickAt(0));
  recorder.WriteEnd(run_end_t{});
  const std::vector<LogEvent> events = EventsOf(file);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].channel, "RUN_END");
}

// A kill gives no time to flush: what is on the disk then is what can be read while the recorder
// lives.
TEST(Recorder, LosesOnlyTheLastMomentsOfAProcessThatIsKilled) {
  const auto file = LogFile("recorder_killed");
  Bus bus("memq://");
  Recorder recorder(bus, file, {0}, RecordedPixels::kNone);
  recorder.WriteHeader(run_header_t{});
  constexpr int kTicks = 2000;  // 300 kB and more, of which 64 KiB may wait.
  for (int i = 0; i < kTicks; ++i) {
    bus.Publish(channel::NavState(0), nav_state_t{});
    while (bus.Handle(0)) continue;
    recorder.WriteTick(TickAt(i));
  }
  RunLogReader reader(file);
  int n_events = 0;
  std::int64_t event_bytes = 0;
  while (const auto event = reader.Next()) {
    EXPECT_EQ(event->number, n_events++);
    event_bytes = static_cast<std::int64_t>(event->bytes.size());
  }
  EXPECT_EQ(reader.TruncatedBytes(), 0);
  EXPECT_TRUE(reader.Damage().empty());
  EXPECT_GE(n_events, kTicks - (1 << 16) / event_bytes);
}

image_t SmoothImage(int width, int height) {
  image_t image{};
  image.width = width;
  image.height = height;
  image.row_stride = 3 * width + 1;  // rows need not be packed
  image.pixelformat = image_t::PIXEL_FORMAT_RGB;
  image.size = image.row_stride * height;
  image.data.resize(static_cast<std::size_t>(image.size));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::uint8_t* pixel = &image.data[static_cast<std::size_t>(y * image.row_stride + 3 * x)];
      pixel[0] = 200;
      pixel[1] = static_cast<std::uint8_t>(2 * x);
      pixel[2] = static_cast<std::uint8_t>(3 * y);
    }
  }
  return image;
}

TEST(Recorder, JpegKeepsThePictureAndRawTheBytes) {
  stereo_frame_t frame{};
  frame.left = SmoothImage(64, 48);
  frame.right = SmoothImage(32, 16);
  for (const RecordedPixels pixels : {RecordedPixels::kRaw, RecordedPixels::kJpeg}) {
    const auto file = LogFile("recorder_pixels");
    Bus bus("memq://");
    Recorder recorder(bus, file, {0}, pixels);
    bus.Publish(channel::Stereo(0), frame);
    while (bus.Handle(0)) continue;
    recorder.WriteTick(TickAt(0));
    recorder.WriteEnd(run_end_t{});

    RunLogReader reader(file);
    const auto event = reader.Next();
    ASSERT_TRUE(event.has_value());
    const auto read = reader.DecodeEvent<stereo_frame_t>(*event);
    if (pixels == RecordedPixels::kRaw) {
      EXPECT_EQ(read.left.data, frame.left.data);
      continue;
    }
    EXPECT_EQ(read.left.pixelformat, image_t::PIXEL_FORMAT_MJPEG);
    const cv::Mat bgr = cv::imdecode(read.left.data, cv::IMREAD_COLOR);
    ASSERT_EQ(bgr.size(), cv::Size(64, 48));
    // Quality 95 quantises a smooth picture by a few grey levels.
    const cv::Vec3b pixel = bgr.at<cv::Vec3b>(20, 30);
    EXPECT_NEAR(pixel[2], 200, 4);
    EXPECT_NEAR(pixel[1], 60, 4);
    EXPECT_NEAR(pixel[0], 60, 4);
  }
}

TEST(Recorder, ImageWhoseSizesDisagreeIsAnErrorNotACrash) {
  stereo_frame_t frame{};
  frame.left = SmoothImage(64, 48);
  frame.right = SmoothImage(64, 48);
  frame.right.height = 4800;
  Bus bus("memq://");
  Recorder recorder(bus, LogFile("recorder_bad_image"), {0}, RecordedPixels::kJpeg);
  bus.Publish(channel::Stereo(0), frame);
  while (bus.Handle(0)) continue;
  EXPECT_THROW(recorder.WriteTick(TickAt(0)), std::runtime_error);
}

TEST(RecordedPixels, NamesAreThoseOfTheCommandLine) {
  EXPECT_EQ(RecordedPixelsFromName("none"), RecordedPixels::kNone);
  EXPECT_EQ(RecordedPixelsFromName("jpeg"), RecordedPixels::kJpeg);
  EXPECT_EQ(RecordedPixelsFromName("raw"), RecordedPixels::kRaw);
  EXPECT_THROW(RecordedPixelsFromName("png"), std::runtime_error);
}

}  // namespace
}  // namespace windhover
