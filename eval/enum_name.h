#pragma once

#include <string>

#include "common/config/fields.h"

namespace windhover {

/// The name of an enum's value, as in YAML.
template <typename Enum>
std::string NameOf(Enum value) {
  for (const auto& [each, name] : kEnumNames<Enum>.names) {
    if (each == value && name != nullptr) return name;
  }
  return "";
}

}  // namespace windhover
