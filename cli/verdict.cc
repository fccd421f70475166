#include "cli/verdict.h"

#include <fmt/format.h>

#include "cli/command.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

// A number of score.json for a column; "-" where there is none.
std::string Number(const Json& json, const char* key, const char* format) {
  const auto it = json.find(key);
  if (it == json.end() || !it->is_number()) return "-";
  return fmt::format(fmt::runtime(format), it->get<double>());
}

std::string Interval(const Json& method, const char* key) {
  const Json::json_pointer path(fmt::format("/ci95/{}", key));
  if (!method.contains(path) || !method[path].is_array() || method[path].size() != 2) return "";
  return fmt::format(" [{:.3f}, {:.3f}]", method[path][0].get<double>(),
                     method[path][1].get<double>());
}

std::string GateRows(const Json& score) {
  if (score["gates"].empty()) return "";
  std::string text = fmt::format("\n{:<44} {:>10} {:>10}  {}\n", "gate", "limit", "value", "");
  for (const Json& gate : score["gates"]) {
    text += fmt::format("{:<44} {:>10} {:>10}  {}\n", gate.value("name", ""),
                        Number(gate, "limit", "{:.4g}"), Number(gate, "value", "{:.4g}"),
                        gate.value("pass", false) ? "pass" : "FAIL");
  }
  return text;
}

}  // namespace

int ExitCodeOf(const std::string& verdict) {
  if (verdict == "pass") return kPass;
  return verdict == "fail" ? kGateFailed : kRunInvalid;
}

std::string MethodsTable(const Json& score) {
  std::string text = fmt::format("{:<12} {:>6} {:>8}  {:<24} {:<24} {:>8}\n", "method", "frames",
                                 "detected", "Abs Rel, misses are 1", "Abs Rel", "bias m");
  for (const auto& [name, method] : score["methods"].items()) {
    text += fmt::format("{:<12} {:>6} {:>8}  {:<24} {:<24} {:>8}\n", name,
                        Number(method, "n", "{:.0f}"), Number(method, "detected", "{:.0f}"),
                        Number(method, "abs_rel_all", "{:.3f}") + Interval(method, "abs_rel_all"),
                        Number(method, "abs_rel", "{:.3f}") + Interval(method, "abs_rel"),
                        Number(method, "bias_m", "{:+.2f}"));
  }
  return text;
}

std::string VerdictTable(const Json& score) {
  const std::string verdict = score.value("verdict", "invalid");
  std::string text = MethodsTable(score) + GateRows(score) + "\nverdict: " + verdict;
  const std::string reason = score.value("invalid_reason", "");
  if (verdict == "invalid" && !reason.empty()) text += ": " + reason;
  return text + "\n";
}

void WriteScoreFiles(const Evaluation& evaluation, const std::filesystem::path& folder) {
  WriteScore(evaluation, folder);
  WriteEstimatesCsv(evaluation, folder);
  WriteSwarmCsv(evaluation, folder);
  WriteJunit(evaluation, folder);
}

}  // namespace windhover
