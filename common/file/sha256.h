#pragma once

#include <filesystem>
#include <string>

namespace windhover {

/// SHA-256 of a file as 64 hexadecimal digits; "" if it cannot be read.
std::string Sha256OfFile(const std::filesystem::path& file);

}  // namespace windhover
