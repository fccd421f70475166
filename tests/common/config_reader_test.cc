#include "common/config/config_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/config_tree.h"

namespace windhover {

enum class Colour { kRed, kGreen };
template <>
inline constexpr EnumNames<Colour> kEnumNames<Colour>{{Colour::kRed, "red"},
                                                      {Colour::kGreen, "green"}};

namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct Part {
  double length_m = 1;
  int count = 2;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("length_m", length_m, InRange{0.5, 10}, "length");
    v.Field("count", count, InRange{1, 5}, "how many");
  }
};

struct Machine {
  std::string name;
  std::uint64_t seed = 1;
  bool enabled = false;
  Colour colour = Colour::kRed;
  std::array<int, 2> size = {3, 4};
  std::vector<std::string> methods = {"a"};
  std::string method = "a";
  double max = kUnset;
  InputFile file;
  Part part;
  std::vector<Part> parts;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("name", name, NotEmpty{}, "its name");
    v.Field("seed", seed, InRange{0, 9e15}, "seed");
    v.Field("enabled", enabled, AnyBool{}, "on or off");
    v.Field("colour", colour, AnyEnum{}, "colour");
    v.Field("size", size, InRange{1, 8}, "width and height");
    v.Field("methods", methods, ItemsOneOf{{"a", "b"}}, "methods");
    v.Field("method", method, OneOf{{"a", "b"}}, "method");
    v.Field("max", max, Optional{}, "bound");
    v.Field("file", file, MayBeEmpty{}, "file");
    v.Section("part", part, "a part");
    v.List("parts", parts, "parts");
  }
};

Machine Read(const std::string& text) {
  Machine machine;
  Findings findings;
  ReadConfig(ParseYaml(text, {"m.yaml", "/folder"}), machine, findings);
  findings.ThrowIfAny();
  return machine;
}

std::vector<std::string> ErrorsOf(const std::string& text) {
  try {
    Read(text);
  } catch (const ConfigError& error) {
    std::vector<std::string> lines;
    std::istringstream in(error.what());
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
  }
  return {};
}

TEST(ConfigReader, ReadsEveryType) {
  const Machine m = Read(R"(
name: "a: b"
seed: 9000000000000000
enabled: true
colour: green
size: [5, 6]
methods: [b, a]
method: b
max: -1.5e3
file: sub/../x.csv
part: {length_m: 2.5}
parts:
  - {count: 1}
  - {length_m: .5, count: +5}
)");
  EXPECT_EQ(m.name, "a: b");
  EXPECT_EQ(m.seed, 9000000000000000U);
  EXPECT_TRUE(m.enabled);
  EXPECT_EQ(m.colour, Colour::kGreen);
  EXPECT_THAT(m.size, ElementsAre(5, 6));
  EXPECT_THAT(m.methods, ElementsAre("b", "a"));
  EXPECT_EQ(m.method, "b");
  EXPECT_EQ(m.max, -1500);
  EXPECT_EQ(m.file.as_given, "sub/../x.csv");
  EXPECT_EQ(m.file.absolute, "/folder/x.csv");
  EXPECT_EQ(m.file.where, "m.yaml:10:7");
  EXPECT_EQ(m.part.length_m, 2.5);
  EXPECT_EQ(m.part.count, 2);  // Left out: stays.
  ASSERT_EQ(m.parts.size(), 2U);
  EXPECT_EQ(m.parts[1].length_m, 0.5);
  EXPECT_EQ(m.parts[1].count, 5);
}

TEST(ConfigReader, ReportsEveryMistakeAtItsPlace) {
  EXPECT_THAT(ErrorsOf(R"(name: x
part:
  lenght_m: 3
  count: 7
colour: blue
size: [1, 2, 3]
seed: -1
enabled: yes
part: {}
)"),
              ElementsAre("m.yaml:3:3: part.lenght_m: must be a known key; did you mean "
                          "'length_m'? (found 'lenght_m')",
                          "m.yaml:4:10: part.count: must be a whole number between 1 and 5 "
                          "(found '7')",
                          "m.yaml:5:9: colour: must be one of red or green (found 'blue')",
                          "m.yaml:6:7: size: must be a list of 2 whole numbers, each between 1 "
                          "and 8 (found a list of 3)",
                          "m.yaml:7:7: seed: must be a whole number between 0 and "
                          "9000000000000000 (found '-1')",
                          "m.yaml:8:10: enabled: must be true or false (found 'yes')",
                          "m.yaml:9:1: part: must be given once (found again, after m.yaml:2:1)"));
}

TEST(ConfigReader, RefusesWhatIsNotAFiniteNumberInItsLimits) {
  for (const std::string value : {".nan", "nan", ".inf", "-.inf", "inf", "1e999", "0.49", "10.01",
                                  "'2'", "2 m", "0x2", "[2]", "", "true", "{}"}) {
    SCOPED_TRACE(value);
    EXPECT_THAT(ErrorsOf("name: x\npart:\n  length_m: " + value),
                ElementsAre(HasSubstr("part.length_m: must be a number between 0.5 and 10")));
  }
  EXPECT_THAT(ErrorsOf("name: x\npart: {count: 2.0}"), ElementsAre(HasSubstr("a whole number")));
  EXPECT_THAT(ErrorsOf("name: x\nseed: 99999999999999999999"),
              ElementsAre(HasSubstr("a whole number")));
  EXPECT_THAT(ErrorsOf("name: x\nmax: .inf"), ElementsAre(HasSubstr("a finite number")));
  EXPECT_TRUE(ErrorsOf("name: x\nmax:").empty());  // An Optional may be taken back.
}

TEST(ConfigReader, RefusesWrongShapes) {
  EXPECT_THAT(ErrorsOf("[]"), ElementsAre("m.yaml:1:1: the file: must be a map (found a list of "
                                          "0)"));
  EXPECT_THAT(ErrorsOf(""), ElementsAre(HasSubstr("must be a map (found nothing)")));
  EXPECT_THAT(ErrorsOf("name: x\npart: 3"), ElementsAre(HasSubstr("part: must be a map")));
  EXPECT_THAT(ErrorsOf("name: x\nparts: {}"), ElementsAre(HasSubstr("parts: must be a list")));
  EXPECT_THAT(ErrorsOf("name: x\nparts: [3]"), ElementsAre(HasSubstr("parts.0: must be a map")));
  EXPECT_THAT(ErrorsOf("name: x\nmethods: [a, a]"), ElementsAre(HasSubstr("each once")));
  EXPECT_THAT(ErrorsOf("name: x\nmethods: []"), ElementsAre(HasSubstr("at least one of a or b")));
  EXPECT_THAT(ErrorsOf("seed: 1"), ElementsAre(HasSubstr("name: must be text, not empty (found "
                                                         "nothing)")));
}

}  // namespace
}  // namespace windhover
