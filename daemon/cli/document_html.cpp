#include <fmt/format.h>

#include "daemon/cli/document.hpp"
#include "daemon/cli/figure_svg.hpp"

namespace odomcalib::cli {
namespace {

// One palette a scheme; orange and blue stay apart for colour-blind readers.
constexpr const char* kStyle = R"(
:root{color-scheme:light dark;--ink:#222;--paper:#fff;--rule:#d8d8d8;--before:#c2571a;--after:#1769aa;--reference:#777}
@media(prefers-color-scheme:dark){:root{--ink:#ddd;--paper:#16181b;--rule:#3a3d42;--before:#f0975a;--after:#6cb6f5;
--reference:#9a9a9a}}
body{font:15px/1.45 system-ui,sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:var(--ink);
background:var(--paper)}
h2{margin:1.6em 0 .3em;font-size:1.15em}p{margin:.35em 0}
.t{overflow-x:auto}table{border-collapse:collapse;margin:.5em 0;font-variant-numeric:tabular-nums}
td,th{padding:.2em .8em;border-bottom:1px solid var(--rule);text-align:right;white-space:nowrap}
td:first-child,th:first-child{text-align:left}
figure{margin:1em 0}figcaption{font-size:.92em}svg{width:100%;max-width:680px;height:auto}
svg text{font-size:11.5px;fill:var(--ink)}.m{text-anchor:middle}.e{text-anchor:end}.s{text-anchor:start}
.g{stroke:var(--rule);stroke-width:.7}.l{fill:none;stroke-width:1.8}
.d{fill:none;stroke-width:3.2;stroke-linecap:round;opacity:.4}
.b{stroke:var(--before)}.a{stroke:var(--after)}.r{stroke:var(--reference)}
@media print{body{margin:0}}
)";

std::string html_row(const std::vector<std::string>& row, const char* cell) {
  std::string out = "<tr>";
  for (const auto& text : row) out += fmt::format("<{0}>{1}</{0}>", cell, escaped(text));
  return out + "</tr>\n";
}

std::string html_of(const Table& table) {
  if (table.rows.empty()) return "";
  std::string out = "<div class=\"t\"><table>\n";
  if (!table.head.empty()) out += html_row(table.head, "th");
  for (const auto& row : table.rows) out += html_row(row, "td");
  return out + "</table></div>\n";
}

std::string html_of(const Figure& figure) {
  const std::string svg = to_svg(figure);
  if (svg.empty()) return "";
  return "<figure>\n" + svg + fmt::format("<figcaption>{}</figcaption></figure>\n", escaped(figure.caption));
}

std::string html_of(const Section& section) {
  std::string out = "<section>\n";
  if (!section.title.empty()) out += fmt::format("<h2>{}</h2>\n", escaped(section.title));
  for (const auto& line : section.lines) out += fmt::format("<p>{}</p>\n", escaped(line));
  out += html_of(section.table);
  for (const auto& figure : section.figures) out += html_of(figure);
  return out + "</section>\n";
}

}  // namespace

std::string to_html(const Document& document) {
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width\"><title>{0}</title>\n"
      "<style>{1}</style></head><body>\n<h1>{0}</h1>\n",
      escaped(document.headline), kStyle);
  for (const Section& section : document.sections) out += html_of(section);
  return out + "</body></html>\n";
}

}  // namespace odomcalib::cli
