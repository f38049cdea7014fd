#include <fmt/format.h>

#include <algorithm>

#include "daemon/cli/document.hpp"
#include "daemon/cli/figure_svg.hpp"
#include "daemon/cli/palette.hpp"

namespace odomcalib::cli {
namespace {

// On a narrow screen a wide table turns: a row becomes a block, each value beside the head of its column.
constexpr const char* kStyle = R"(@media print{:root{color-scheme:light}}
body{font:15px/1.45 system-ui,sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:var(--ink);
background:var(--paper);overflow-wrap:anywhere}
h1{border-left:.35em solid var(--rule);padding-left:.5em}
h1.good{border-color:var(--good);color:var(--good)}h1.doubtful{border-color:var(--doubtful);color:var(--doubtful)}
h1.bad{border-color:var(--bad);color:var(--bad)}
h2{margin:1.6em 0 .3em;font-size:1.15em}p{margin:.35em 0}
table{border-collapse:collapse;margin:.5em 0;font-variant-numeric:tabular-nums}
td,th{padding:.2em .7em;border-bottom:1px solid var(--rule);text-align:left;vertical-align:baseline;overflow-wrap:normal}
th{vertical-align:bottom}.n{text-align:right}
figure{margin:1em 0;break-inside:avoid}figcaption{font-size:.92em}svg{display:block;width:100%;max-width:680px;height:auto}
.k{margin:.2em 0}.k span{white-space:nowrap;margin-right:1.4em}.k svg{display:inline;width:1.5em;height:.7em;margin-right:.4em}
svg text{font-size:13px;fill:var(--ink)}.m{text-anchor:middle}.e{text-anchor:end}
.map .l.r{stroke-width:6;opacity:.45}
.g{stroke:var(--rule);stroke-width:.7}.l{fill:none;stroke-width:1.8}
.d{fill:none;stroke-width:3.4;stroke-linecap:round;opacity:.55}
.b{stroke:var(--before)}.a{stroke:var(--after)}.r{stroke:var(--reference)}
@media screen and (max-width:600px){body{margin:1em auto}td,th{padding:.2em .35em}svg text{font-size:21px}
.l{stroke-width:3}.d{stroke-width:6}.w,.w tbody,.w tr,.w td{display:block}.w .h{display:none}
.w tr{padding:.4em 0;border-bottom:1px solid var(--rule)}.w td{border:0;padding:.05em 0;display:flex;gap:1em;overflow-wrap:anywhere}
.w td:first-child{font-weight:600}.w td:empty{display:none}
.w td[data-h]{justify-content:space-between;text-align:right}.w td[data-h]::before{content:attr(data-h);flex:none;max-width:45%;text-align:left}}
@media print{body{margin:0;max-width:none;padding:0;font-size:10.5pt}td,th{padding:.15em .45em}tr{break-inside:avoid}
h2{break-after:avoid}figure>svg{max-width:140mm}}
)";

constexpr double kNarrow = 360.0;    // px, what a phone has for a table
constexpr double kCharacter = 8.5;   // px of a character, at most
constexpr double kColumnGap = 10.5;  // px, the padding of a cell

/// Whether a phone has no room for it.
bool is_wide(const Table& table) {
  std::vector<std::size_t> widths;
  const auto take = [&widths](const std::vector<std::string>& row) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
  };
  take(table.head);
  for (const auto& row : table.rows) take(row);
  double width = 0.0;
  for (const std::size_t characters : widths)
    width += kColumnGap + kCharacter * static_cast<double>(characters);
  return width > kNarrow;
}

/// For each column, the attribute that right-aligns its cells, or nothing.
std::vector<const char*> alignments_of(const Table& table) {
  std::size_t columns = table.head.size();
  for (const auto& row : table.rows) columns = std::max(columns, row.size());
  std::vector<const char*> alignments;
  for (std::size_t k = 0; k < columns; ++k)
    alignments.push_back(is_of_numbers(table, k) ? " class=\"n\"" : "");
  return alignments;
}

std::string head_of(const std::vector<std::string>& head, const std::vector<const char*>& alignments) {
  std::string out = "<tr class=\"h\">";
  for (std::size_t k = 0; k < head.size(); ++k)
    out += fmt::format("<th{}>{}</th>", alignments[k], escaped(head[k]));
  return out + "</tr>\n";
}

/// Each cell carries the head of its column, for where the table turns.
std::string row_of(const std::vector<std::string>& row, const std::vector<std::string>& head,
                   const std::vector<const char*>& alignments) {
  std::string out = "<tr>";
  for (std::size_t k = 0; k < row.size(); ++k) {
    const bool is_named = k > 0 && k < head.size() && !head[k].empty();
    const std::string name = is_named ? fmt::format(" data-h=\"{}\"", escaped(head[k])) : "";
    out += fmt::format("<td{}{}>{}</td>", alignments[k], name, escaped(row[k]));
  }
  return out + "</tr>\n";
}

/// Key of the figure: the quantity drawn upwards, and the names of the curves.
std::string key_of(const Figure& figure) {
  std::string out = fmt::format("<p class=\"k\"><span>{}</span>", escaped(figure.y_label));
  for (const Curve& curve : figure.curves)
    if (!curve.label.empty())
      out += fmt::format(
          "<span><svg viewBox=\"0 0 24 10\" aria-hidden=\"true\"><path class=\"l {}\" d=\"M0 "
          "5h24\"/></svg>{}</span>",
          class_of(curve.tone), escaped(curve.label));
  return out + "</p>\n";
}

}  // namespace

const char* class_of(Document::Tone tone) {
  switch (tone) {
    case Document::Tone::good:
      return "good";
    case Document::Tone::doubtful:
      return "doubtful";
    case Document::Tone::bad:
      return "bad";
    case Document::Tone::plain:
      break;
  }
  return "plain";
}

std::string html_of(const Table& table) {
  if (table.rows.empty()) return "";
  const auto alignments = alignments_of(table);
  std::string out = is_wide(table) ? "<table class=\"w\">\n" : "<table>\n";
  if (!table.head.empty()) out += head_of(table.head, alignments);
  for (const auto& row : table.rows) out += row_of(row, table.head, alignments);
  return out + "</table>\n";
}

std::string html_of(const Figure& figure) {
  const std::string svg = to_svg(figure);
  if (svg.empty()) return "";
  return "<figure>\n" + key_of(figure) + svg +
         fmt::format("<figcaption>{}</figcaption></figure>\n", escaped(figure.caption));
}

std::string html_of(const Section& section) {
  std::string out = "<section>\n";
  if (!section.title.empty()) out += fmt::format("<h2>{}</h2>\n", escaped(section.title));
  for (const auto& line : section.lines) out += fmt::format("<p>{}</p>\n", escaped(line));
  out += html_of(section.table);
  for (const auto& figure : section.figures) out += html_of(figure);
  return out + "</section>\n";
}

std::string page_of(const std::string& title, const std::string& style, const std::string& body) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width\"><title>{0}</title>\n"
      "<style>{1}{2}{3}</style></head><body>\n{4}</body></html>\n",
      escaped(title), kPalette, kStyle, style, body);
}

std::string to_text(const Document& document, bool legend, std::size_t width) {
  std::string out = wrapped(document.headline, width);
  for (const Section& section : document.sections) {
    out += "\n";
    if (!section.title.empty()) out += wrapped(section.title, width);
    for (const auto& line : section.lines) out += wrapped("  " + line, width);
    out += laid_out(section.table, legend, width);
  }
  return out;
}

std::string page_of(const Document& document) {
  std::string body =
      fmt::format("<h1 class=\"{}\">{}</h1>\n", class_of(document.tone), escaped(document.headline));
  for (const Section& section : document.sections) body += html_of(section);
  return page_of(document.headline, "", body);
}

}  // namespace odomcalib::cli
