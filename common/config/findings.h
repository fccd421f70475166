#pragma once

#include <string>
#include <vector>

#include "common/config/config_node.h"

namespace windhover {

/// Collects everything wrong with a configuration, to be reported at once.
class Findings {
 public:
  /// "WHERE: path: must be `must` (found `found`)".
  void MustBe(const SourceLocation& where, const std::string& path, const std::string& must,
              const std::string& found);
  /// "WHERE: path: must `must` (found `found`)".
  void Must(const SourceLocation& where, const std::string& path, const std::string& must,
            const std::string& found);

  /// Whether something is wrong with `path`, or with a key inside it.
  bool Mention(const std::string& path) const;

  bool empty() const { return findings_.empty(); }

  /// @throws ConfigError with one line for each finding, those of one file in its order.
  void ThrowIfAny() const;

 private:
  struct Finding {
    SourceLocation where;
    std::string path, text;
  };
  std::vector<Finding> findings_;
};

}  // namespace windhover
