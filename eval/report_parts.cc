#include "eval/report_parts.h"

#include <fmt/format.h>

#include "eval/report_style.h"
#include "eval/text_file.h"

namespace windhover {

std::string ReportSection(const std::string& title, const std::string& body) {
  if (body.empty()) return "";
  return fmt::format("<section><h2>{}</h2>\n{}</section>\n", title, body);
}

std::string ReportTile(const std::string& value, const std::string& label) {
  return fmt::format("<div class=\"tile\"><b>{}</b><span>{}</span></div>\n", XmlEscaped(value),
                     XmlEscaped(label));
}

std::string ReportPage(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">" +
         fmt::format("<title>{}</title><style>{}</style></head><body>\n{}</body></html>\n", title,
                     kReportStyle, body);
}

}  // namespace windhover
