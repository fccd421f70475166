#pragma once

#include "cli/reproduce.h"
#include "learn/detector/picture_scene.h"

namespace windhover {

/// How a detector is tried on aircraft that it never learned from, before and after it was
/// fine-tuned on a few pictures of them.
struct UnseenTargetsPlan {
  std::filesystem::path detector;  ///< Its card.
  std::filesystem::path folder;    ///< Where pictures to fine-tune by and tuned cards go.
  Scenario base;                   ///< Whose rig and sensor take the pictures.
  Lesson lesson;                   ///< What corrections learned, without these aircraft.
  std::vector<TargetKind> targets = {TargetKind::kHexacopter, TargetKind::kFlyingWing};
  int pairs = 200;        ///< To try on.
  int tuning_pairs = 24;  ///< Fewer than 50 images, as the paper.
  int tuning_steps = 300;
  std::vector<std::string> tuning;  ///< Further arguments of the training program.
  /// Runs the training program with these arguments and gives its exit status.
  std::function<int(const std::vector<std::string>& arguments)> train;
};

/// For `windhover reproduce targets`, whose table is `targets`; `detector`, `folder` and `train`
/// are left to the caller.
UnseenTargetsPlan UnseenTargetsOf(Effort effort, const ReproducedTable& targets,
                                  const ReproduceOptions& options);

/// Adds a row for each aircraft, whose boxes its distances are of ("boxes": "untuned", "labelled",
/// "fine-tuned"), and method. Distances are of the best detection of a pair, whatever it shows;
/// "ap50" and "recall" say how good detections are. Where there is no detector, or none can be
/// trained, rows say so. @throws ConfigError if the card or its weights cannot be used.
void AddUnseenTargets(const UnseenTargetsPlan& plan, const ReproduceOptions& options,
                      nlohmann::ordered_json* targets);

}  // namespace windhover
