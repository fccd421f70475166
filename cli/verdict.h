#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "eval/evaluation.h"

namespace windhover {

/// Exit code of a verdict: pass 0, fail 1, invalid 3.
int ExitCodeOf(const std::string& verdict);

/// Section `methods` of score.json as a table for a terminal.
std::string MethodsTable(const nlohmann::ordered_json& score);

/// score.json as a table for a terminal: methods, gates, verdict.
std::string VerdictTable(const nlohmann::ordered_json& score);

/// Writes score.json, estimates.csv, swarm.csv and junit.xml into `folder`.
void WriteScoreFiles(const Evaluation& evaluation, const std::filesystem::path& folder);

}  // namespace windhover
