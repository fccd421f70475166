#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sweep/sweep_config.h"

namespace windhover {

/// A factor whose configuration has been checked.
class Factor {
 public:
  explicit Factor(FactorConfig config);

  const std::string& key() const { return config_.key; }

  /// Whether every value is a number.
  bool is_number() const { return is_number_; }
  FactorScale scale() const { return config_.scale; }

  /// The values of a grid, in order: those listed, or `levels` evenly spaced ones, of a normal
  /// distribution its quantiles (k + 1/2) / levels.
  std::vector<std::string> Levels() const;

  /// The value that a share `u` of all values lies below, 0 <= u < 1, as YAML.
  std::string At(double u) const;

  /// Index of a listed value; nothing if the factor is a range.
  std::optional<std::size_t> IndexOf(const std::string& value) const;

 private:
  double Quantile(double u) const;

  FactorConfig config_;
  bool is_number_;
};

/// A finite number, if that is what the text is.
std::optional<double> NumberOf(const std::string& text);

}  // namespace windhover
