#include "learn/estimator_check.h"

#include "estimator/correction_card.h"
#include "estimator/detector.h"
#include "estimator/range_estimator.h"

namespace windhover {

void CheckEstimators(const AircraftConfig& config) {
  if (config.observe == Observe::kImage) CheckDetector(config.estimator);
  if (config.estimator.correction.empty()) return;
  ReadCorrectionCard(config.estimator.correction);
  for (const std::string& method : config.estimator.methods) MakeRangeEstimator(method, config);
}

}  // namespace windhover
