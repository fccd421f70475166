#include "common/bus/codec.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/message_types.h"
#include "lcmtypes/layout_generator/lcm_schema.h"
#include "lcmtypes/layouts.h"

namespace windhover {
namespace {

using testing::HasSubstr;

using Bytes = std::vector<std::uint8_t>;

void PutInt32(Bytes* bytes, std::size_t offset, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) {
    (*bytes)[offset + static_cast<std::size_t>(i)] =
        static_cast<std::uint8_t>(value >> (24 - 8 * i));
  }
}

// What is wrong with `bytes`, or "" if nothing is.
template <typename Message>
std::string Reason(const Bytes& bytes) {
  try {
    Decode<Message>(bytes);
    return "";
  } catch (const MalformedMessage& e) {
    return e.what();
  }
}

image_t SmallImage() {
  image_t image{};
  image.width = 2;
  image.height = 1;
  image.row_stride = 2;
  image.pixelformat = image_t::PIXEL_FORMAT_GRAY;
  image.size = 2;
  image.data = {10, 20};
  image.nmetadata = 1;
  image.metadata.resize(1);
  image.metadata[0].key = "k";
  image.metadata[0].n = 1;
  image.metadata[0].value = {30};
  return image;
}

// Offsets in an encoded SmallImage: fingerprint 8, utime 8, four int32, then these.
constexpr std::size_t kSizeAt = 32;
constexpr std::size_t kMetadataCountAt = kSizeAt + 4 + 2;
constexpr std::size_t kKeyLengthAt = kMetadataCountAt + 4;
constexpr std::size_t kKeyAt = kKeyLengthAt + 4;

TEST(Codec, RoundTrip) {
  const image_t read = Decode<image_t>(Encode(SmallImage()));
  EXPECT_EQ(read.data, (Bytes{10, 20}));
  ASSERT_EQ(read.metadata.size(), 1u);
  EXPECT_EQ(read.metadata[0].key, "k");
  EXPECT_EQ(read.metadata[0].value, Bytes{30});
}

TEST(Codec, RejectsEveryMalformedMessageThatCrashesLcmsDecoder) {
  struct Case {
    const char* what;
    std::size_t offset;
    std::uint32_t value;
    const char* reason;
  };
  const std::vector<Case> table = {
      {"count -1", kSizeAt, 0xffffffff, "size is -1"},
      {"count 2^31 - 1", kSizeAt, 0x7fffffff, "data has 2147483647 elements"},
      {"count one too large", kSizeAt, 20, "data has 20 elements"},
      {"count of structs -1", kMetadataCountAt, 0xffffffff, "nmetadata is -1"},
      {"count of structs 2^31 - 1", kMetadataCountAt, 0x7fffffff, "metadata has 2147483647"},
      {"string length 0", kKeyLengthAt, 0, "key is a string of length 0"},
      {"string length -1", kKeyLengthAt, 0xffffffff, "key is -1"},
      {"string length too large", kKeyLengthAt, 100, "key has 100 elements"},
      {"string cut before its NUL", kKeyLengthAt, 1, "key is not closed"},
      {"fingerprint", 0, 0x12345678, "fingerprint is 0x12345678"},
  };
  for (const Case& bad : table) {
    Bytes bytes = Encode(SmallImage());
    PutInt32(&bytes, bad.offset, bad.value);
    EXPECT_THAT(Reason<image_t>(bytes), HasSubstr(bad.reason)) << bad.what;
  }
}

TEST(Codec, RejectsACountWhoseBytesOverflow32Bits) {
  uav_truth_t truth{};
  Bytes bytes = Encode(truth);
  PutInt32(&bytes, bytes.size() - 4, 0x20000001);  // 8 * n is 8 in 32 bits
  bytes.resize(bytes.size() + 8);
  EXPECT_THAT(Reason<uav_truth_t>(bytes), HasSubstr("modal_state has 536870913 elements"));
}

TEST(Codec, RejectsEveryTruncationAndAnyTail) {
  const Bytes whole = Encode(SmallImage());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_NE(Reason<image_t>(Bytes(whole.begin(), whole.begin() + static_cast<long>(size))), "")
        << size;
  }
  Bytes longer = whole;
  longer.push_back(0);
  EXPECT_THAT(Reason<image_t>(longer), HasSubstr("1 bytes too many"));
}

TEST(Codec, RejectsAStringWithANulInside) {
  Bytes bytes = Encode(SmallImage());
  bytes[kKeyAt] = 0;
  EXPECT_THAT(Reason<image_t>(bytes), HasSubstr("key is not closed by its first NUL"));
  image_t image = SmallImage();
  image.metadata[0].key = std::string("a\0b", 3);
  EXPECT_THROW(Encode(image), std::runtime_error);
}

TEST(Codec, RejectsMessagesAboveTheLimitOfTheirType) {
  EXPECT_THAT(Reason<tick_t>(Bytes(MessageLayout<tick_t>::kMaxBytes + 1)),
              HasSubstr("more than 29"));
  image_t image{};
  image.data.resize(std::size_t{65} << 20);
  image.size = static_cast<std::int32_t>(image.data.size());
  EXPECT_THROW(Encode(image), std::runtime_error);
}

TEST(Codec, ChecksCountsInNestedMessages) {
  stereo_frame_t frame{};
  frame.right.metadata.resize(1);
  frame.right.nmetadata = 1;
  EXPECT_NO_THROW(Encode(frame));
  frame.right.metadata[0].n = 1;
  try {
    Encode(frame);
    FAIL() << "expected an error";
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), HasSubstr("image_metadata_t.value has 0 elements"));
  }
}

// --- Every type --------------------------------------------------------------------------------

// Random well-formed messages, written byte by byte from the .lcm files.
class MessageWriter {
 public:
  explicit MessageWriter(unsigned seed) : random_(seed) {}

  template <typename Message>
  Bytes Write() {
    bytes_.clear();
    Put(static_cast<std::uint64_t>(Message::getHash()), 8);
    PutStruct(MessageLayout<Message>::kName);
    return bytes_;
  }

 private:
  void Put(std::uint64_t value, std::size_t n_bytes) {
    for (std::size_t i = n_bytes; i-- > 0;) {
      bytes_.push_back(static_cast<std::uint8_t>(value >> 8 * i));
    }
  }
  void PutStruct(const std::string& type) {
    std::map<std::string, std::size_t> counts;
    const std::string file = std::string(WINDHOVER_SOURCE_DIR) + "/lcmtypes/" + type + ".lcm";
    for (const LcmMember& member : ReadLcmFile(file).members) {
      if (member.is_count) {
        counts[member.name] = random_() % 4;
        Put(counts[member.name], 4);
        continue;
      }
      const std::size_t n_fixed = std::max<std::size_t>(member.n_fixed, 1);
      const std::size_t n = member.count.empty() ? n_fixed : counts.at(member.count);
      for (std::size_t i = 0; i < n; ++i) PutValue(member.type);
    }
  }
  void PutValue(const std::string& type) {
    if (const std::size_t n_bytes = PrimitiveBytes(type)) {
      Put(random_(), n_bytes);
    } else if (type == "string") {
      const std::size_t length = random_() % 4;
      Put(length + 1, 4);
      for (std::size_t i = 0; i < length; ++i) Put(1 + random_() % 255, 1);
      Put(0, 1);
    } else {
      PutStruct(type);
    }
  }

  std::mt19937_64 random_;
  Bytes bytes_;
};

// One or two of the damages that networks, disks and other people's programs do.
Bytes Mutated(Bytes bytes, std::mt19937* random) {
  constexpr std::array<std::uint32_t, 9> kEvil = {0,          1,          0xffffffff, 0x7fffffff, 2,
                                                  0x80000000, 0x20000001, 0x10000000, 64};
  for (unsigned n = 1 + (*random)() % 2; n > 0 && bytes.size() > 4; --n) {
    const std::size_t at = (*random)() % (bytes.size() - 3);
    switch ((*random)() % 4) {
      case 0:
        PutInt32(&bytes, at, kEvil[(*random)() % kEvil.size()]);
        break;
      case 1:
        bytes[at] ^= static_cast<std::uint8_t>(1u << (*random)() % 8);
        break;
      case 2:
        bytes.resize(at);
        break;
      default:
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), 1 + (*random)() % 9, 0);
    }
  }
  return bytes;
}

template <typename Message>
class EveryMessage : public testing::Test {};

template <typename... Messages>
using TestTypes = testing::Types<Messages...>;
using AllMessages = WithAllMessages<TestTypes>;

struct MessageName {
  template <typename Message>
  static std::string GetName(int) {
    return MessageLayout<Message>::kName;
  }
};
TYPED_TEST_SUITE(EveryMessage, AllMessages, MessageName);

TYPED_TEST(EveryMessage, WellFormedMessagesPassAndComeBackAsTheyWere) {
  MessageWriter writer(1);
  for (int i = 0; i < 50; ++i) {
    const Bytes bytes = writer.Write<TypeParam>();
    ASSERT_EQ(Reason<TypeParam>(bytes), "");
    EXPECT_EQ(Encode(Decode<TypeParam>(bytes)), bytes);
  }
}

// Whatever passes the check must be what the decoder makes of it, byte for byte: then the decoder
// has read nothing else. (Under the sanitizers this also watches its memory.)
TYPED_TEST(EveryMessage, MutatedMessagesAreRejectedOrComeBackAsTheyWere) {
  MessageWriter writer(2);
  std::mt19937 random(3);
  int n_rejected = 0;
  for (int i = 0; i < 1000; ++i) {
    const Bytes bytes = Mutated(writer.Write<TypeParam>(), &random);
    try {
      EXPECT_EQ(Encode(Decode<TypeParam>(bytes)), bytes);
    } catch (const MalformedMessage&) {
      ++n_rejected;
    }
  }
  EXPECT_GT(n_rejected, 100);
}

TYPED_TEST(EveryMessage, LeastSizeIsThatOfTheEmptyMessage) {
  EXPECT_EQ(static_cast<std::size_t>(TypeParam{}.getEncodedSize()),
            MessageLayout<TypeParam>::kMinBytes + 8);
}

TEST(MessageTypes, FingerprintsOfAllTypesAreListed) {
  const std::vector<type_fingerprint_t> all = AllFingerprints();
  const auto range = std::find_if(all.begin(), all.end(),
                                  [](const auto& entry) { return entry.name == "range_t"; });
  ASSERT_NE(range, all.end());
  EXPECT_EQ(range->fingerprint, range_t::getHash());
}

TEST(MessageTypes, EachChannelHasOneType) {
  EXPECT_EQ(TypeOnChannel("TICK"), "tick_t");
  EXPECT_EQ(TypeOnChannel("TICK_DONE"), "tick_done_t");
  EXPECT_EQ(TypeOnChannel("STEREO_12"), "stereo_frame_t");
  EXPECT_EQ(TypeOnChannel("UAV_TRUTH"), "world_truth_t");
  EXPECT_EQ(TypeOnChannel("MY_OWN"), "");
  EXPECT_THROW(CheckChannelLayout("IMU_0", Encode(tick_t{})), MalformedMessage);
  EXPECT_NO_THROW(CheckChannelLayout("MY_OWN", Bytes{1, 2, 3}));
}

// --- bot_core --------------------------------------------------------------------------------

// LCM's fingerprint, from its published description (lcm-gen's lcmgen.c): a 64-bit hash is fed
// the characters of each member's name, of its type if that is a primitive, and of its array
// dimensions; then nested types' hashes are added and the sum is rotated by one.
class LcmHash {
 public:
  LcmHash& Member(const std::string& name, const std::string& primitive = "") {
    String(name);
    if (!primitive.empty()) String(primitive);
    Byte(0);
    return *this;
  }
  LcmHash& VectorMember(const std::string& name, const std::string& primitive,
                        const std::string& count) {
    String(name);
    if (!primitive.empty()) String(primitive);
    Byte(1);  // dimensions
    Byte(1);  // of variable size
    String(count);
    return *this;
  }
  std::int64_t Finish(std::int64_t nested = 0) const {
    const std::uint64_t sum =
        static_cast<std::uint64_t>(value_) + static_cast<std::uint64_t>(nested);
    return static_cast<std::int64_t>((sum << 1) + (sum >> 63));
  }

 private:
  void Byte(std::uint8_t byte) {
    // hash = ((hash << 8) ^ (hash >> 55)) + c on a signed 64-bit integer.
    const auto shifted = static_cast<std::int64_t>(static_cast<std::uint64_t>(value_) << 8);
    value_ = static_cast<std::int64_t>(static_cast<std::uint64_t>(shifted ^ (value_ >> 55)) + byte);
  }
  void String(const std::string& text) {
    Byte(static_cast<std::uint8_t>(text.size()));
    for (const char c : text) Byte(static_cast<std::uint8_t>(c));
  }

  std::int64_t value_ = 0x12345678;
};

// Members as in bot_core_image_metadata_t.lcm and bot_core_image_t.lcm of libbot2.
TEST(BotCore, ImageHasTheFingerprintOfBotCores) {
  const std::int64_t metadata = LcmHash()
                                    .Member("key", "string")
                                    .Member("n", "int32_t")
                                    .VectorMember("value", "byte", "n")
                                    .Finish();
  EXPECT_EQ(image_metadata_t::getHash(), metadata);
  const std::int64_t image = LcmHash()
                                 .Member("utime", "int64_t")
                                 .Member("width", "int32_t")
                                 .Member("height", "int32_t")
                                 .Member("row_stride", "int32_t")
                                 .Member("pixelformat", "int32_t")
                                 .Member("size", "int32_t")
                                 .VectorMember("data", "byte", "size")
                                 .Member("nmetadata", "int32_t")
                                 .VectorMember("metadata", "", "nmetadata")
                                 .Finish(metadata);
  EXPECT_EQ(image_t::getHash(), image);
}

// lcm-spy's image viewers know these numbers (camunits' FourCC codes).
TEST(BotCore, PixelFormatsAreFourCharacterCodes) {
  const auto four_cc = [](const char* text) {
    std::uint32_t code = 0;
    std::memcpy(&code, text, 4);
    return static_cast<std::int32_t>(code);
  };
  EXPECT_EQ(image_t::PIXEL_FORMAT_GRAY, four_cc("GREY"));
  EXPECT_EQ(image_t::PIXEL_FORMAT_RGB, four_cc("RGB3"));
  EXPECT_EQ(image_t::PIXEL_FORMAT_MJPEG, four_cc("MJPG"));
  EXPECT_EQ(image_t::PIXEL_FORMAT_BAYER_RGGB, four_cc("XXX4"));
}

}  // namespace
}  // namespace windhover
