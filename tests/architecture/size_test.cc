// Functions and files stay small (docs/testing.md): at most 60 lines a function and 500 a file,
// and only few may pass 40 and 300.

#include <regex>
#include <string>

#include <gtest/gtest.h>

#include "source_files.h"

namespace windhover::test {
namespace {

namespace fs = std::filesystem;

constexpr size_t kGoodFunction = 40, kLongestFunction = 60;
constexpr size_t kGoodFile = 300, kLongestFile = 500;
// Shares that may pass the good length, from the measured habits of well-kept projects.
constexpr double kLongFunctions = 0.04, kLongFiles = 0.08;

struct FunctionExtent {
  size_t first_line, n_lines;
};

// clang-format fixes the layout: a body opens on a line that ends in "{" and closes on the
// first later line that is "}" at the same indentation. Namespaces and types are no functions.
std::vector<FunctionExtent> Functions(const std::vector<std::string>& lines) {
  static const std::regex kOpens(R"(^( {0,4})[A-Za-z~].*\{$)");
  static const std::regex kNoFunction(
      R"(^ *(namespace|struct|class|enum|union|extern|template|using|inline const|inline constexpr|constexpr|const|static const)\b[^(]*\{$)");
  std::vector<FunctionExtent> functions;
  for (size_t i = 0; i < lines.size(); ++i) {
    std::smatch match;
    if (!std::regex_match(lines[i], match, kOpens)) continue;
    if (std::regex_match(lines[i], kNoFunction)) continue;
    const std::string close = match[1].str() + "}";
    for (size_t j = i + 1; j < lines.size(); ++j) {
      if (!lines[j].starts_with(close)) continue;
      functions.push_back({i + 1, j - i + 1});
      break;
    }
    if (match[1].length() == 0 && !functions.empty()) i += functions.back().n_lines - 1;
  }
  return functions;
}

TEST(Size, CountsTheLinesOfAFunction) {
  const auto found = Functions({"namespace a {", "int F(int x) {", "  if (x) {", "    return 1;",
                                "  }", "  return 0;", "}", "}  // namespace a"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].first_line, 2u);
  EXPECT_EQ(found[0].n_lines, 6u);
}

TEST(Size, FunctionsAndFilesAreShort) {
  size_t n_files = 0, n_long_files = 0, n_functions = 0, n_long_functions = 0;
  for (const fs::path& file : SourceFiles(WINDHOVER_SOURCE_DIR)) {
    const auto lines = Lines(file);
    ++n_files;
    n_long_files += lines.size() > kGoodFile ? 1 : 0;
    EXPECT_LE(lines.size(), kLongestFile) << file;
    for (const FunctionExtent& f : Functions(lines)) {
      ++n_functions;
      n_long_functions += f.n_lines > kGoodFunction ? 1 : 0;
      EXPECT_LE(f.n_lines, kLongestFunction) << file << ":" << f.first_line;
    }
  }
  EXPECT_GT(n_functions, 20u) << "the scan found almost nothing; is the source path right?";
  EXPECT_LE(n_long_functions, kLongFunctions * n_functions) << "of " << n_functions;
  EXPECT_LE(n_long_files, kLongFiles * n_files) << "of " << n_files;
}

}  // namespace
}  // namespace windhover::test
