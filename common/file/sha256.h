#pragma once

#include <filesystem>
#include <string>

namespace windhover {

/// SHA-256 of a file as 64 hexadecimal digits; "" if it cannot be read.
std::string Sha256OfFile(const std::filesystem::path& file);

/// One for all files of a folder and its folders: of the text that
/// `find -type f -printf '%P\n' | LC_ALL=C sort | xargs -d '\n' sha256sum` prints there.
std::string Sha256OfFolder(const std::filesystem::path& folder);

}  // namespace windhover
