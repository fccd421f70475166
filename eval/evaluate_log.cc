#include <fstream>

#include "eval/evaluation.h"
#include "eval/run_log_record.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

/// What lies beside the log may be missing or broken: the score does not depend on it.
Json ReadJsonIfThere(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) return nullptr;
  Json json = Json::parse(in, nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded()) return nullptr;
  return json;
}

}  // namespace

Evaluation Evaluate(const std::filesystem::path& run_dir_or_log) {
  const bool is_dir = std::filesystem::is_directory(run_dir_or_log);
  const auto log = is_dir ? run_dir_or_log / "run.lcm" : run_dir_or_log;
  const auto dir = log.parent_path();
  return EvaluateRecord(ReadRunRecord(log), ReadJsonIfThere(dir / "timing.json"),
                        ReadJsonIfThere(dir / "manifest.json"));
}

}  // namespace windhover
