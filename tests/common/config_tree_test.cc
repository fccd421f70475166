#include "common/config/config_tree.h"

#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/fields.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

using testing::HasSubstr;

ConfigNode Parse(const std::string& text) { return ParseYaml(text, {"t.yaml", ""}); }

std::string ErrorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

std::string Repeated(const std::string& text, int n) {
  std::string all;
  for (int i = 0; i < n; ++i) all += text;
  return all;
}

TEST(ParseYaml, KnowsWhereEachValueStands) {
  const ConfigNode root = Parse("a: 1\nb:\n  - {c: x}\n");
  EXPECT_EQ(root.Find("a")->where.ToString(), "t.yaml:1:4");
  EXPECT_EQ(NearestNode(root, "b.0.c").where.ToString(), "t.yaml:3:9");
  EXPECT_EQ(NearestNode(root, "b.0.c").scalar, "x");
  EXPECT_EQ(NearestNode(root, "b.1.c").where.ToString(), "t.yaml:3:3");  // As far as it goes.
}

TEST(ParseYaml, ExpandsAliases) {
  const ConfigNode root = Parse("a: &x {k: 1}\nb: *x\n");
  EXPECT_EQ(NearestNode(root, "b.k").scalar, "1");
}

TEST(ParseYaml, ReportsSyntaxErrorsAtTheirPlace) {
  EXPECT_THAT(ErrorOf([] { Parse("a: 1\nb: [1, 2\n"); }), HasSubstr("t.yaml:3:1: must be YAML"));
  EXPECT_THAT(ErrorOf([] { Parse("a: *nobody"); }), HasSubstr("t.yaml:1:4: must be YAML"));
  EXPECT_THAT(ErrorOf([] { Parse("a: 1\n---\nb: 2"); }), HasSubstr("one YAML document"));
  EXPECT_THAT(ErrorOf([] { Parse("? [1]\n: 2"); }), HasSubstr("must be text as a key"));
}

TEST(ParseYaml, SurvivesHostileText) {
  for (const std::string nest : {"[", "{a: ", "- ", "{", "? ", "&a [", "!!x "}) {
    SCOPED_TRACE(nest);
    EXPECT_NE(ErrorOf([&] { Parse("a:\n  " + Repeated(nest, 20000)); }), "");
  }
  std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 20; ++i) {
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" +
            Repeated("*a" + std::to_string(i - 1) + ", ", 9) + "x]\n";
  }
  EXPECT_THAT(ErrorOf([&] { Parse(bomb); }), HasSubstr("must have at most 100000 values"));
  EXPECT_THAT(ErrorOf([] { Parse("a: &x [*x]"); }), HasSubstr("must not contain itself"));
}

TEST(LoadConfigTree, MergesMapsAndReplacesTheRest) {
  const TemporaryFolder folder;
  folder.Write("presets/base.yaml", "rig: {f: 1, b: 2}\nlist: [1, 2]\nx: 1\n");
  folder.Write("presets/middle.yaml", "extends: base.yaml\nx: 2\n");
  const auto file =
      folder.Write("top.yaml", "extends: presets/middle.yaml\nrig: {b: 3}\nlist: [9]\n");
  const ConfigNode root = LoadConfigTree(file);
  EXPECT_EQ(NearestNode(root, "rig.f").scalar, "1");
  EXPECT_EQ(NearestNode(root, "rig.b").scalar, "3");
  EXPECT_EQ(NearestNode(root, "x").scalar, "2");
  EXPECT_EQ(NearestNode(root, "list").items.size(), 1U);
  EXPECT_EQ(root.Find("extends"), nullptr);
  const std::string base = (folder.path() / "presets/base.yaml").string();
  EXPECT_EQ(NearestNode(root, "rig.f").where.ToString(), base + ":1:10");
  EXPECT_EQ(NearestNode(root, "rig.b").where.ToString(), file.string() + ":2:10");
  EXPECT_EQ(NearestNode(root, "rig.f").where.source->folder, folder.path() / "presets");
}

TEST(LoadConfigTree, RefusesCirclesAndWhatIsNoFile) {
  const TemporaryFolder folder;
  const auto a = folder.Write("a.yaml", "x: 1\nextends: b.yaml\n");
  const auto b = folder.Write("b.yaml", "extends: ./a.yaml\n");
  EXPECT_EQ(
      ErrorOf([&] { LoadConfigTree(a); }),
      b.string() + ":1:10: extends: must not lead back to itself (found '" + a.string() + "')");
  const auto lost = folder.Write("lost.yaml", "extends: nowhere.yaml\n");
  EXPECT_EQ(ErrorOf([&] { LoadConfigTree(lost); }),
            lost.string() + ":1:10: extends: must be a readable file (found no such file)");
  EXPECT_THAT(ErrorOf([&] { LoadConfigTree(folder.path()); }), HasSubstr("found something else"));
  EXPECT_THAT(ErrorOf([] { LoadConfigTree("/dev/zero"); }), HasSubstr("found something else"));
  const auto big = folder.Write("big.yaml", std::string((1 << 20) + 1, '#'));
  EXPECT_THAT(ErrorOf([&] { LoadConfigTree(big); }), HasSubstr("must be at most 1048576 bytes"));
}

TEST(ApplyOverride, SetsValuesByPath) {
  ConfigNode root = Parse("a: {b: 1}\nlist: [{c: 1}, {c: 2}]\n");
  ApplyOverride(root, "a.b=[1, 2]", 1);
  ApplyOverride(root, "list.1.c=x=y", 2);
  ApplyOverride(root, "new.key=3", 3);
  ApplyOverride(root, "a={d: 4}", 4);
  EXPECT_EQ(NearestNode(root, "a.b").items.size(), 2U);
  EXPECT_EQ(NearestNode(root, "list.1.c").scalar, "x=y");
  EXPECT_EQ(NearestNode(root, "list.0.c").scalar, "1");
  EXPECT_EQ(NearestNode(root, "new.key").scalar, "3");
  EXPECT_EQ(NearestNode(root, "a.d").scalar, "4");
  EXPECT_EQ(NearestNode(root, "list.1.c").where.ToString(), "--set:2:10");
  EXPECT_EQ(NearestNode(root, "list.1.c").where.source->folder, std::filesystem::current_path());
}

TEST(ApplyOverride, RefusesWhatItCannotPlace) {
  ConfigNode root = Parse("a: 1\nlist: [1]\n");
  EXPECT_EQ(ErrorOf([&] { ApplyOverride(root, "a", 1); }),
            "--set:1:1: a: must be of the form key.path=value (found 'a')");
  EXPECT_EQ(ErrorOf([&] { ApplyOverride(root, "list.1=2", 3); }),
            "--set:3:1: list.1: must be an index below 1 (found '1')");
  EXPECT_EQ(ErrorOf([&] { ApplyOverride(root, "a.b=2", 2); }),
            "--set:2:1: a.b: must be a key inside a section (found '1')");
  EXPECT_THAT(ErrorOf([&] { ApplyOverride(root, "a=[1", 2); }),
              HasSubstr("--set:2:1: must be YAML"));
}

}  // namespace
}  // namespace windhover
