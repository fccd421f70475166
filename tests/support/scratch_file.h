#pragma once

#include <fstream>
#include <string>

#include <gtest/gtest.h>

namespace windhover::test {

/// Writes `content` to a file of the running test's own and returns its path.
inline std::string ScratchFile(const std::string& content, const std::string& name = "input") {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  std::string file =
      testing::TempDir() + test->test_suite_name() + "_" + test->name() + "_" + name + ".csv";
  for (char& c : file) {
    if (c == '<' || c == '>' || c == ':') c = '_';
  }
  std::ofstream(file) << content;
  return file;
}

}  // namespace windhover::test
