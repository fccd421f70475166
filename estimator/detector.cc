#include "estimator/detector.h"

#include <stdexcept>

#include <fmt/format.h>

#include "estimator/classical_detector.h"
#include "estimator/yolox_detector.h"

namespace windhover {

std::unique_ptr<Detector> MakeDetector(const EstimatorConfig& config) {
  const std::string& name = config.detector;
  if (name == "classical") return std::make_unique<ClassicalDetector>();
  if (name.starts_with("yolox_")) return MakeYoloxDetector(name, config.detector_model);
  throw std::invalid_argument(fmt::format("there is no detector '{}'", name));
}

}  // namespace windhover
