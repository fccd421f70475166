#include "common/bus/run_log.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lcmtypes/imu_t.hpp"
#include "lcmtypes/tick_t.hpp"

namespace windhover {
namespace {

using testing::HasSubstr;

constexpr int kEvents = 1000;

std::filesystem::path LogFile(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / ("windhover_run_log_" + name + ".lcm");
}

std::string BytesOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void Store(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

imu_t Sample(int i) {
  imu_t imu{};
  imu.utime = 5000 * i;
  imu.id = i;
  return imu;
}

// Returns the file's bytes; every event has the same size.
std::string WriteLog(const std::filesystem::path& file) {
  RunLogWriter log(file);
  for (int i = 0; i < kEvents; ++i) log.Write("IMU_3", Sample(i).utime, Sample(i));
  log.Flush();
  return BytesOf(file);
}

struct Read {
  std::vector<int> ids;
  std::vector<LogDamage> damage;
  std::int64_t truncated = 0;
};

Read ReadLog(const std::filesystem::path& file) {
  RunLogReader reader(file);
  Read read;
  while (const auto event = reader.Next()) read.ids.push_back(reader.DecodeEvent<imu_t>(*event).id);
  read.damage = reader.Damage();
  read.truncated = reader.TruncatedBytes();
  return read;
}

TEST(RunLog, ReadsWhatWasWritten) {
  const auto file = LogFile("whole");
  WriteLog(file);
  RunLogReader reader(file);
  for (int i = 0; i < kEvents; ++i) {
    const auto event = reader.Next();
    ASSERT_TRUE(event.has_value());
    EXPECT_EQ(event->number, i);
    EXPECT_EQ(event->utime, 5000 * i);
    EXPECT_EQ(event->channel, "IMU_3");
    EXPECT_EQ(reader.DecodeEvent<imu_t>(*event).id, i);
  }
  EXPECT_FALSE(reader.Next().has_value());
  EXPECT_TRUE(reader.Damage().empty());
}

TEST(RunLog, SameEventsAreTheSameBytes) {
  EXPECT_EQ(WriteLog(LogFile("first")), WriteLog(LogFile("second")));
}

// The layout that LCM's own tools expect: sync word, number, time stamp, lengths, channel, data.
TEST(RunLog, WorkedExample) {
  const auto file = LogFile("example");
  RunLogWriter log(file);
  const std::vector<std::uint8_t> data = {0xab};
  log.WriteBytes("AB", 0x0102, data);
  log.Flush();
  EXPECT_EQ(BytesOf(file), std::string("\xED\xA1\xDA\x01"
                                       "\0\0\0\0\0\0\0\0"
                                       "\0\0\0\0\0\0\x01\x02"
                                       "\0\0\0\x02"
                                       "\0\0\0\x01"
                                       "AB\xab",
                                       31));
}

TEST(RunLog, GoesOnAfterJunkInsideAnEvent) {
  const auto file = LogFile("junk_inside");
  const std::string whole = WriteLog(file);
  const std::size_t event = whole.size() / kEvents;
  const std::size_t at = 50 * event + 40;
  Store(file, whole.substr(0, at) + "JUNKYOU" + whole.substr(at));
  const Read read = ReadLog(file);
  ASSERT_EQ(read.ids.size(), static_cast<std::size_t>(kEvents - 1));
  EXPECT_EQ(read.ids[49], 49);
  EXPECT_EQ(read.ids[50], 51);
  ASSERT_EQ(read.damage.size(), 1u);
  EXPECT_EQ(read.damage[0].offset, static_cast<std::int64_t>(50 * event));
  EXPECT_EQ(read.damage[0].n_bytes, static_cast<std::int64_t>(event + 7));
}

TEST(RunLog, LosesNothingToJunkBetweenEvents) {
  const auto file = LogFile("junk_between");
  const std::string whole = WriteLog(file);
  const std::size_t at = 50 * (whole.size() / kEvents);
  Store(file, whole.substr(0, at) + "JUNKYOU" + whole.substr(at));
  const Read read = ReadLog(file);
  EXPECT_EQ(read.ids.size(), static_cast<std::size_t>(kEvents));
  ASSERT_EQ(read.damage.size(), 1u);
  EXPECT_EQ(read.damage[0].offset, static_cast<std::int64_t>(at));
  EXPECT_EQ(read.damage[0].n_bytes, 7);
}

TEST(RunLog, ADamagedLengthCostsOneEvent) {
  const auto file = LogFile("length");
  const std::string whole = WriteLog(file);
  const std::size_t event = whole.size() / kEvents;
  for (const std::size_t field : {std::size_t{20}, std::size_t{24}}) {  // of channel, of data
    for (const char value : {'\x7f', '\x80', '\x01'}) {
      for (const std::size_t byte : {0, 2, 3}) {
        std::string bytes = whole;
        bytes[7 * event + field + byte] =
            static_cast<char>(bytes[7 * event + field + byte] ^ value);
        Store(file, bytes);
        const Read read = ReadLog(file);
        EXPECT_EQ(read.ids.size(), static_cast<std::size_t>(kEvents - 1)) << field << " " << byte;
        ASSERT_EQ(read.damage.size(), 1u);
        EXPECT_EQ(read.damage[0].n_bytes, static_cast<std::int64_t>(event));
      }
    }
  }
}

TEST(RunLog, UnfinishedEventAtTheEndIsHarmless) {
  const auto file = LogFile("truncated");
  const std::string whole = WriteLog(file);
  const std::size_t event = whole.size() / kEvents;
  for (std::size_t left = 1; left < event; ++left) {
    Store(file, whole.substr(0, whole.size() - event + left));
    const Read read = ReadLog(file);
    ASSERT_EQ(read.ids.size(), static_cast<std::size_t>(kEvents - 1));
    EXPECT_TRUE(read.damage.empty()) << left;
    EXPECT_EQ(read.truncated, static_cast<std::int64_t>(left));
  }
}

TEST(RunLog, AFileThatIsNoLogIsAllDamage) {
  const auto file = LogFile("no_log");
  Store(file, std::string(3'000'000, 'x'));
  const Read read = ReadLog(file);
  EXPECT_TRUE(read.ids.empty());
  ASSERT_EQ(read.damage.size(), 1u);
  EXPECT_EQ(read.damage[0].n_bytes, 3'000'000);
}

TEST(RunLog, FindsASyncWordAcrossTheBordersOfItsSearch) {
  const auto file = LogFile("border");
  const std::string whole = WriteLog(file);
  for (int shift = -4; shift <= 4; ++shift) {
    const auto n_junk = static_cast<std::size_t>((1 << 20) + shift);
    Store(file, std::string(n_junk, 'x') + whole);
    EXPECT_EQ(ReadLog(file).ids.size(), static_cast<std::size_t>(kEvents)) << shift;
  }
}

TEST(RunLog, NamesTheEventThatIsOfAnotherType) {
  const auto file = LogFile("type");
  WriteLog(file);
  RunLogReader reader(file);
  reader.Next();
  const auto event = reader.Next();
  try {
    reader.DecodeEvent<tick_t>(*event);
    FAIL() << "expected an error";
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), HasSubstr("event 1 at byte"));
    EXPECT_THAT(e.what(), HasSubstr("IMU_3 is not a well-formed tick_t"));
  }
}

TEST(RunLog, FilesThatCannotBeOpenedOrWrittenAreErrors) {
  EXPECT_THROW(RunLogReader("/nonexistent/run.lcm"), std::runtime_error);
  EXPECT_THROW(RunLogWriter("/nonexistent/run.lcm"), std::runtime_error);
  RunLogWriter full("/dev/full");
  EXPECT_THROW(
      {
        full.Write("IMU_3", 0, Sample(0));
        full.Flush();
      },
      std::runtime_error);
}

}  // namespace
}  // namespace windhover
