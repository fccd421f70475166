#pragma once

#include <filesystem>
#include <string>

namespace windhover {

/// Replaces the content of `file`.
/// @throws std::runtime_error naming the file if it cannot be written in full.
void WriteTextFile(const std::filesystem::path& file, const std::string& text);

/// `text` with & < > " as entities and control characters as blanks, for XML and HTML.
std::string XmlEscaped(const std::string& text);

}  // namespace windhover
