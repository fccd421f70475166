#pragma once

#include <string>

namespace windhover {

/// A headed part of a report; empty if `body` is.
std::string ReportSection(const std::string& title, const std::string& body);

/// A number with its name, for a row of tiles.
std::string ReportTile(const std::string& value, const std::string& label);

/// A page that needs nothing else, with the report's style; `title` and `body` are HTML.
std::string ReportPage(const std::string& title, const std::string& body);

}  // namespace windhover
