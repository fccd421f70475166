#include "common/table/number_table.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/fields.h"

namespace windhover {
namespace {

using testing::ElementsAre;

class NumberTableTest : public testing::Test {
 protected:
  // Writes `content` to a file of this test's own.
  std::string File(const std::string& content) {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    const std::string file = testing::TempDir() + "number_table_" + test->name() + ".csv";
    std::ofstream(file) << content;
    return file;
  }

  static std::string Findings(const std::string& file, int n_columns, bool more_allowed = false) {
    FileFindings findings("f.csv");
    ReadNumberTable(file, n_columns, more_allowed, &findings);
    try {
      findings.ThrowIfAny();
    } catch (const ConfigError& e) {
      return e.what();
    }
    return "";
  }
};

TEST_F(NumberTableTest, ReadsCommasSpacesCommentsAndHeader) {
  FileFindings findings("");
  const auto table = ReadNumberTable(
      File("\xEF\xBB\xBF# t [s], x\r\n\n1, +2.5e1\r\n# note\n3   4\n5\t6\n"), 2, false, &findings);
  EXPECT_TRUE(findings.empty());
  EXPECT_THAT(table.header, ElementsAre("t [s]", "x"));
  ASSERT_EQ(table.rows.size(), 3u);
  EXPECT_THAT(table.rows[0].values, ElementsAre(1, 25));
  EXPECT_THAT(table.rows[1].values, ElementsAre(3, 4));
  EXPECT_THAT(table.rows[2].values, ElementsAre(5, 6));
  EXPECT_EQ(table.rows[1].line, 5);
}

TEST_F(NumberTableTest, HeaderNeedsNoHash) {
  FileFindings findings("");
  const auto table = ReadNumberTable(File("f_hz,g2\n1,2\n"), 2, false, &findings);
  EXPECT_THAT(table.header, ElementsAre("f_hz", "g2"));
  EXPECT_EQ(table.rows.size(), 1u);
}

TEST_F(NumberTableTest, ReportsEveryBadLine) {
  EXPECT_EQ(Findings(File("1,2\n3\n4,x\n5,nan\n6,\n7,8,9\n"), 2),
            "f.csv:2: must have 2 columns (found 1)\n"
            "f.csv:3: column 2: must be a finite number (found 'x')\n"
            "f.csv:4: column 2: must be a finite number (found 'nan')\n"
            "f.csv:5: column 2: must be a finite number (found '')\n"
            "f.csv:6: must have 2 columns (found 3)");
}

TEST_F(NumberTableTest, MoreColumnsOnlyWhereAllowed) {
  EXPECT_EQ(Findings(File("7,8,9\n1,2,3\n"), 2, true), "");
  EXPECT_EQ(Findings(File("7,8,9\n1,2\n"), 2, true), "f.csv:2: must have 3 columns (found 2)");
}

TEST_F(NumberTableTest, StopsListingAfterTwenty) {
  std::string content;
  for (int i = 0; i < 25; ++i) content += "1\n";
  const std::string text = Findings(File(content), 2);
  EXPECT_THAT(text, testing::HasSubstr("f.csv:20: "));
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("f.csv:21: ")));
  EXPECT_THAT(text, testing::EndsWith("and 5 more like these"));
}

TEST_F(NumberTableTest, SaysThatAFileIsMissing) {
  EXPECT_EQ(Findings("/nonexistent/f.csv", 2), "f.csv: cannot be opened");
}

}  // namespace
}  // namespace windhover
