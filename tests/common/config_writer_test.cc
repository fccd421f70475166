#include "common/config/config_writer.h"

#include <bit>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/config_reader.h"
#include "common/config/config_tree.h"
#include "common/config/key_lister.h"
#include "common/random/random_stream.h"

namespace windhover {
namespace {

struct Item {
  double a_m = 1;
  double max = kUnset;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("a_m", a_m, InRange{-1e308, 1e308}, "a length");
    v.Field("max", max, Optional{}, "a bound");
  }
};

struct Document {
  std::string text = "t";
  Item section;
  std::vector<Item> list;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("text", text, MayBeEmpty{}, "some text");
    v.Section("section", section, "a section");
    v.List("list", list, "a list");
  }
};

Document Reread(const std::string& text) {
  Document document;
  Findings findings;
  ReadConfig(ParseYaml(text, {"t", ""}), document, findings);
  findings.ThrowIfAny();
  return document;
}

TEST(ConfigWriter, WorkedExample) {
  Document document{
      .text = "a: \"b\"", .section = {.a_m = 0.1}, .list = {{}, {.a_m = 2, .max = 3}}};
  EXPECT_EQ(WriteConfig(document, PathStyle::kAsGiven),
            "text: \"a: \\\"b\\\"\"\n"
            "section:\n"
            "  a_m: 0.1\n"
            "list:\n"
            "  - a_m: 1\n"
            "  - a_m: 2\n"
            "    max: 3\n");
}

TEST(ConfigWriter, EveryTextReadsBackUnchanged) {
  for (const std::string text : {"",
                                 " ",
                                 "null",
                                 "~",
                                 "true",
                                 "1e3",
                                 "#",
                                 "a #b",
                                 "- a",
                                 "ü µ",
                                 "a\nb\t\"\\",
                                 "{",
                                 "*a",
                                 "\x01\x7f",
                                 "a: b",
                                 "'",
                                 "path/to-file_1.csv",
                                 "/abs",
                                 "%",
                                 "!x",
                                 "&y",
                                 "=",
                                 "<<"}) {
    SCOPED_TRACE(text);
    Document document;
    document.text = text;
    EXPECT_EQ(Reread(WriteConfig(document, PathStyle::kAsGiven)).text, text);
  }
}

TEST(ConfigWriter, EveryNumberReadsBackWithTheSameBits) {
  RandomStream random(1, "config_writer_test");
  for (int i = 0; i < 2000; ++i) {
    Document document;
    document.section.a_m = std::bit_cast<double>(random());
    if (!(std::abs(document.section.a_m) < 1e308)) continue;
    const Document back = Reread(WriteConfig(document, PathStyle::kAsGiven));
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back.section.a_m),
              std::bit_cast<std::uint64_t>(document.section.a_m));
  }
}

TEST(KeyLister, ListsPathsUnitsAndLimits) {
  const std::vector<KeyDescription> keys = ListKeys<Document>();
  ASSERT_EQ(keys.size(), 7U);
  EXPECT_EQ(keys[0].path, "text");
  EXPECT_EQ(keys[1].path, "section");
  EXPECT_EQ(keys[2].path, "section.a_m");
  EXPECT_EQ(keys[2].unit, "m");
  EXPECT_EQ(keys[2].initial, "1");
  EXPECT_EQ(keys[5].path, "list.N.a_m");
  EXPECT_EQ(keys[6].limits, "may be left out");
}

TEST(KeyLister, TakesUnitsFromNames) {
  EXPECT_EQ(UnitOfKey("speed_mps"), "m/s");
  EXPECT_EQ(UnitOfKey("gain_per_s"), "1/s");
  EXPECT_EQ(UnitOfKey("duration_ms"), "ms");
  EXPECT_EQ(UnitOfKey("angular_rate_rms_radps"), "rad/s rms");
  EXPECT_EQ(UnitOfKey("methods"), "");
}

}  // namespace
}  // namespace windhover
