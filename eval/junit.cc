#include "eval/junit.h"

#include <fmt/format.h>

#include "eval/text_file.h"

namespace windhover {
namespace {

std::string TestCase(const std::string& name, const std::string& failure) {
  const std::string head =
      fmt::format("  <testcase classname=\"windhover\" name=\"{}\"", XmlEscaped(name));
  if (failure.empty()) return head + "/>\n";
  return head +
         fmt::format(">\n    <failure message=\"{}\"/>\n  </testcase>\n", XmlEscaped(failure));
}

std::string TestSuite(const std::string& name, const std::string& cases, std::size_t n_cases,
                      std::size_t n_failures) {
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\">\n{}</testsuite>\n",
      XmlEscaped(name), n_cases, n_failures, cases);
}

}  // namespace

std::string JunitXml(const std::string& suite, const std::string& validity_case,
                     const std::string& invalid_reason, std::span<const GateResult> gates) {
  std::string cases = TestCase(validity_case, invalid_reason);
  std::size_t n_failures = invalid_reason.empty() ? 0 : 1;
  for (const GateResult& gate : gates) {
    cases += TestCase(gate.name, gate.message);
    if (!gate.pass) ++n_failures;
  }
  return TestSuite(suite, cases, gates.size() + 1, n_failures);
}

}  // namespace windhover
