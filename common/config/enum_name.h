#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/config/fields.h"

namespace windhover {

/// The names of an enum's values, as in YAML.
template <typename Enum>
std::vector<std::string> NamesOf() {
  std::vector<std::string> names;
  for (const auto& [value, name] : kEnumNames<Enum>.names) {
    if (name != nullptr) names.push_back(name);
  }
  return names;
}

/// The name of one value.
template <typename Enum>
std::string NameOf(Enum value) {
  for (const auto& [each, name] : kEnumNames<Enum>.names) {
    if (each == value && name != nullptr) return name;
  }
  return "";
}

/// The value of a name, if it is one.
template <typename Enum>
std::optional<Enum> ValueNamed(const std::string& wanted) {
  for (const auto& [value, name] : kEnumNames<Enum>.names) {
    if (name != nullptr && wanted == name) return value;
  }
  return std::nullopt;
}

}  // namespace windhover
