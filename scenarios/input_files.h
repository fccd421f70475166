#pragma once

#include <string>
#include <vector>

#include "scenarios/scenario.h"

namespace windhover {

/// A file that a run depends on, and the key that names it.
struct NamedInputFile {
  std::string key;  ///< "aircraft.1.trajectory.file"
  InputFile file;
};

/// Every input file that `scenario` names, in the order of its keys.
std::vector<NamedInputFile> InputFilesOf(Scenario scenario);

}  // namespace windhover
