#pragma once

#include <string>

namespace windhover {

/// `text` with & < > " as entities and control characters as blanks, for XML and HTML.
std::string XmlEscaped(const std::string& text);

}  // namespace windhover
