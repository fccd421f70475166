#pragma once

#include <string>
#include <vector>

#include "common/config/config_node.h"
#include "common/config/fields.h"
#include "common/config/findings.h"

namespace windhover {

/// Whether the input files that a scenario names have to be there. kCardComesLater: they must, but
/// estimator.correction is trained before a run and need not even be named.
enum class InputFiles { kMustExist, kCardComesLater, kNotNeeded };

/// Findings of rules between fields, each at its place in the tree that they were read from.
class RuleFindings {
 public:
  /// `root` and `findings` must outlive this.
  RuleFindings(const ConfigNode& root, InputFiles files, Findings& findings)
      : root_(root), files_(files), findings_(findings) {}

  InputFiles files() const { return files_; }

  /// `uses`: what else the rule looks at. Where that is wrong, or `path` itself, the rule would
  /// only repeat a mistake that is already reported, and nothing is added.
  void MustBe(const std::string& path, const std::string& must, const std::string& found,
              const std::vector<std::string>& uses = {});

  /// That `file` can be read, and is named if it is needed, for the `reason` that key `reason_path`
  /// gives.
  void CheckFile(const std::string& path, const InputFile& file, bool is_needed,
                 const std::string& reason, const std::string& reason_path);

 private:
  const ConfigNode& root_;
  InputFiles files_;
  Findings& findings_;
};

}  // namespace windhover
