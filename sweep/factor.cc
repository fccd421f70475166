#include "sweep/factor.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "common/config/value_text.h"
#include "common/random/inverse_normal.h"

namespace windhover {
namespace {

double NormalCdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

}  // namespace

std::optional<double> NumberOf(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

Factor::Factor(FactorConfig config) : config_(std::move(config)) {
  is_number_ = std::all_of(config_.values.begin(), config_.values.end(),
                           [](const std::string& text) { return NumberOf(text).has_value(); });
}

std::vector<std::string> Factor::Levels() const {
  if (!config_.values.empty()) return config_.values;
  std::vector<std::string> levels;
  const bool is_normal = !std::isnan(config_.sigma);
  for (int k = 0; k < config_.levels; ++k) {
    levels.push_back(
        WriteValue(Quantile(is_normal ? (k + 0.5) / config_.levels : k / (config_.levels - 1.0))));
  }
  return levels;
}

std::string Factor::At(double u) const {
  const std::size_t n = config_.values.size();
  if (n == 0) return WriteValue(Quantile(u));
  return config_.values[std::min(n - 1, static_cast<std::size_t>(u * static_cast<double>(n)))];
}

std::optional<std::size_t> Factor::IndexOf(const std::string& value) const {
  const auto at = std::find(config_.values.begin(), config_.values.end(), value);
  if (at == config_.values.end()) return std::nullopt;
  return static_cast<std::size_t>(at - config_.values.begin());
}

double Factor::Quantile(double u) const {
  const bool is_log = config_.scale == FactorScale::kLog;
  const auto scaled = [&](double x) { return is_log ? std::log(x) : x; };
  const auto unscaled = [&](double x) { return is_log ? std::exp(x) : x; };
  if (std::isnan(config_.sigma)) {
    // The ends as they are written, whatever exp(log(x)) makes of them.
    if (u <= 0) return config_.min;
    if (u >= 1) return config_.max;
    return unscaled(scaled(config_.min) + u * (scaled(config_.max) - scaled(config_.min)));
  }
  // Normal, cut off at min and max where those are given.
  const double mean = scaled(config_.mean);
  const auto share_below = [&](double bound) {
    return NormalCdf((scaled(bound) - mean) / config_.sigma);
  };
  const double low = std::isnan(config_.min) ? 0 : share_below(config_.min);
  const double high = std::isnan(config_.max) ? 1 : share_below(config_.max);
  constexpr double kTail = 1e-9;  // A Sobol sequence begins at 0.
  const double p = std::clamp(low + u * (high - low), kTail, 1 - kTail);
  const double value = unscaled(mean + config_.sigma * InverseNormal(p));
  // Rounding may lead past a bound; comparisons with one that is not given are false.
  if (value < config_.min) return config_.min;
  return value > config_.max ? config_.max : value;
}

}  // namespace windhover
