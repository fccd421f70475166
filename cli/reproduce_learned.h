#pragma once

#include "cli/reproduce.h"
#include "learn/pretraining.h"

namespace windhover {

/// Adds what a correction learned (learn/audit.h) on data set 1 of uavde_12mm: "learned":
/// [{"question", "baseline", "offset1", "pcm", "verdict"}] of Abs Rel on the test split.
void AddLearnedAudits(const PcmRecipe& recipe, const ReproduceOptions& options,
                      nlohmann::ordered_json* audits);

/// Learned on the presets pretrain and uavde_12mm; the new rig has another offset, milder boxes
/// and looks at a P600.
PretrainingPlan PretrainingOf(Effort effort, const std::filesystem::path& scenarios);

/// Does pre-training pay? {"table", "unseen", "rows": [{"method", "n_tuples",
/// "pretrained_pretrain", "pretrained_uavde_12mm", "scratch", "offset1", "gain_…", and the same of
/// joint_mlp as "joint_mlp_…"}]}: Abs Rel on the test flights as
/// {"mean", "ci95"}, Student's t over data sets; a gain is the error from scratch less the
/// pre-trained one, of the same data sets, with a verdict in words. Seeds and threads are those of
/// `options`.
nlohmann::ordered_json ReproducePretraining(PretrainingPlan plan, const ReproduceOptions& options);

/// Parts of ReproducedText() and ReproducedPage().
std::string LearnedAuditsText(const nlohmann::ordered_json& audits);
std::string LearnedAuditsHtml(const nlohmann::ordered_json& audits);
std::string PretrainingText(const nlohmann::ordered_json& table);
std::string PretrainingHtml(const nlohmann::ordered_json& table);

}  // namespace windhover
