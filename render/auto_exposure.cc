#include "render/auto_exposure.h"

#include <algorithm>
#include <cmath>

namespace windhover {

AutoExposure::AutoExposure(const AutoExposureConfig& config, double nominal_s)
    : config_(config),
      nominal_s_(nominal_s),
      log_product_(std::log(
          std::clamp(nominal_s, config.min_ms * 1e-3, config.max_ms * 1e-3 * config.max_gain))) {}

ExposureSetting AutoExposure::Setting() const {
  if (config_.mode == AutoExposureMode::kOff) return {nominal_s_};
  const double product_s = std::exp(log_product_);
  const double duration_s = std::min(product_s, config_.max_ms * 1e-3);
  return {duration_s, product_s / duration_s};
}

void AutoExposure::Observe(double mean_light) {
  constexpr double kDarkest = 1e-4;  // Half the first grey value of an 8 bit sRGB image.
  const double error = std::log(config_.target / std::max(mean_light, kDarkest));
  log_product_ = std::clamp(log_product_ + config_.speed * error, std::log(config_.min_ms * 1e-3),
                            std::log(config_.max_ms * 1e-3 * config_.max_gain));
}

}  // namespace windhover
