#pragma once

#include <fmt/format.h>

#include "common/config/fields.h"

namespace windhover {

/// What `read` returns; its mistakes, which are of the file's content, begin with the place at
/// which the file is named. @throws ConfigError
template <typename Read>
auto AtItsPlace(const InputFile& file, const Read& read) {
  try {
    return read();
  } catch (const ConfigError& error) {
    if (file.where.empty()) throw;
    throw ConfigError(fmt::format("{}: {}", file.where, error.what()));
  }
}

}  // namespace windhover
