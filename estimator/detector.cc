#include "estimator/detector.h"

#include <stdexcept>

#include <fmt/format.h>

#include "estimator/classical_detector.h"

namespace windhover {

std::unique_ptr<Detector> MakeDetector(const std::string& name) {
  if (name == "classical") return std::make_unique<ClassicalDetector>();
  throw std::invalid_argument(fmt::format("there is no detector '{}'", name));
}

}  // namespace windhover
