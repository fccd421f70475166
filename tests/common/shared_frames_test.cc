#include "common/bus/shared_frames.h"

#include <cstdlib>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace windhover {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

image_t Image(std::int64_t utime, std::vector<std::uint8_t> data) {
  image_t image{};
  image.utime = utime;
  image.data = std::move(data);
  image.size = static_cast<std::int32_t>(image.data.size());
  return image;
}

std::string ErrorOf(SharedFrameReader* reader, const image_t& image) {
  try {
    reader->PixelsOf(image);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(SharedFrames, LeaveOnlyAPlaceInTheMessage) {
  SharedFrameWriter writer;
  SharedFrameReader reader;
  image_t image = Image(7, {1, 2, 3});
  const image_t sent = image;
  EXPECT_THAT(writer.Share(&image), ElementsAre(1, 2, 3));
  EXPECT_EQ(image.size, 0);
  EXPECT_TRUE(image.data.empty());
  EXPECT_THAT(reader.PixelsOf(image), ElementsAre(1, 2, 3));
  reader.Fetch(&image);
  EXPECT_EQ(image.data, sent.data);
  EXPECT_EQ(image.size, 3);
  EXPECT_EQ(image.nmetadata, 0);
  EXPECT_TRUE(image.metadata.empty());
}

TEST(SharedFrames, ReadMessagesThatHoldTheirPixels) {
  SharedFrameReader reader;
  image_t image = Image(7, {4, 5});
  EXPECT_THAT(reader.PixelsOf(image), ElementsAre(4, 5));
  reader.Fetch(&image);
  EXPECT_THAT(image.data, ElementsAre(4, 5));
}

TEST(SharedFrames, KeepAPairAndTheOneBefore) {
  SharedFrameWriter writer;
  SharedFrameReader reader;
  std::vector<image_t> images;
  for (std::uint8_t i = 0; i <= kSharedFrameSlots; ++i) {
    images.push_back(Image(i, {i, i}));
    writer.Share(&images.back());
  }
  for (std::uint8_t i = 1; i <= kSharedFrameSlots; ++i) {
    EXPECT_THAT(reader.PixelsOf(images[i]), ElementsAre(i, i));
  }
  EXPECT_THAT(ErrorOf(&reader, images[0]), HasSubstr("another image"));
}

TEST(SharedFrames, GrowWithTheImages) {
  SharedFrameWriter writer;
  SharedFrameReader reader;
  for (const std::size_t size : {10, 100'000, 10}) {
    image_t image = Image(1, std::vector<std::uint8_t>(size, 9));
    writer.Share(&image);
    EXPECT_EQ(reader.PixelsOf(image).size(), size);
  }
}

// What a message says is whatever its sender likes.
TEST(SharedFrames, BelieveNothing) {
  SharedFrameWriter writer;
  SharedFrameReader reader;
  image_t good = Image(7, {1, 2, 3});
  writer.Share(&good);
  const std::string place(good.metadata[0].value.begin(), good.metadata[0].value.end());
  const std::string memory = place.substr(0, place.find(' ', place.find(' ') + 1));
  char name[] = "/tmp/windhover_shared_frames_XXXXXX";
  const FileDescriptor file(mkstemp(name));
  ASSERT_EQ(ftruncate(file.get(), 10'000), 0);
  unlink(name);
  const std::string plain_file = std::to_string(getpid()) + " " + std::to_string(file.get());
  for (const std::string& text :
       {std::string(), std::string("x"), std::string("0 0 64 1 7"), memory + " 64",
        memory + " 63 1 7", memory + " -1 1 7", memory + " 64 99999999999999999999 7",
        memory + " 64 18446744073709551615 7", memory + " 1000000000 3 7", memory + " 64 3 8",
        std::string("999999999 3 64 1 7"), plain_file + " 64 1 0"}) {
    image_t bad = good;
    bad.metadata[0].value.assign(text.begin(), text.end());
    EXPECT_THAT(ErrorOf(&reader, bad), HasSubstr("shared frame: ")) << text;
  }
  EXPECT_EQ(ErrorOf(&reader, good), "");
}

}  // namespace
}  // namespace windhover
