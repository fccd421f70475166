#include "estimator/detector.h"

#include <stdexcept>

#include <fmt/format.h>

#include "estimator/classical_detector.h"
#include "estimator/yolox_detector.h"

namespace windhover {

namespace {

constexpr char kClassical[] = "classical";

void CheckName(const std::string& name) {
  if (name == kClassical || name.starts_with("yolox_")) return;
  throw std::invalid_argument(fmt::format("there is no detector '{}'", name));
}

}  // namespace

std::unique_ptr<Detector> MakeDetector(const EstimatorConfig& config) {
  CheckName(config.detector);
  if (config.detector == kClassical) return std::make_unique<ClassicalDetector>();
  return MakeYoloxDetector(config.detector, config.detector_model);
}

void CheckDetector(const EstimatorConfig& config) {
  CheckName(config.detector);
  if (config.detector != kClassical) CheckYoloxCard(config.detector, config.detector_model);
}

}  // namespace windhover
