#pragma once

#include <nlohmann/json.hpp>

#include "eval/evaluation.h"

namespace windhover {

/// score.json without its gates and verdict, which are judged on it. Numbers that do not exist
/// are null.
nlohmann::ordered_json ScoreJson(const Evaluation& evaluation);

/// Its section `methods`.
nlohmann::ordered_json MethodsJson(const std::vector<MethodScore>& methods);

/// Adds what the gates say.
void AddVerdict(const Evaluation& evaluation, nlohmann::ordered_json* score);

}  // namespace windhover
