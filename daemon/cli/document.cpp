#include "daemon/cli/document.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace odomcalib::cli {
namespace {

// Columns of a terminal: every byte but the continuation bytes of UTF-8.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::vector<std::size_t> widths(const Table& table) {
  std::vector<std::size_t> out;
  const auto widen = [&out](const std::vector<std::string>& row) {
    out.resize(std::max(out.size(), row.size()), 0);
    for (std::size_t i = 0; i < row.size(); ++i) out[i] = std::max(out[i], width_of(row[i]));
  };
  widen(table.head);
  for (const auto& row : table.rows) widen(row);
  return out;
}

std::string line_of(const std::vector<std::string>& row, const std::vector<std::size_t>& columns) {
  std::string line = " ";
  for (std::size_t i = 0; i < row.size(); ++i) {
    const std::string pad(columns[i] - width_of(row[i]), ' ');
    line += i == 0 ? " " + row[i] + pad : "  " + pad + row[i];
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

std::string text_of(const Table& table, bool legend) {
  const auto columns = widths(table);
  std::string out;
  if (legend && !table.head.empty()) out += line_of(table.head, columns);
  for (const auto& row : table.rows) out += line_of(row, columns);
  return out;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

std::string html_row(const std::vector<std::string>& row, const char* cell) {
  std::string out = "<tr>";
  for (const auto& text : row) out += fmt::format("<{0}>{1}</{0}>", cell, escaped(text));
  return out + "</tr>\n";
}

std::string html_of(const Section& section) {
  std::string out;
  if (!section.title.empty()) out += fmt::format("<h2>{}</h2>\n", escaped(section.title));
  for (const auto& line : section.lines) out += fmt::format("<p>{}</p>\n", escaped(line));
  if (section.table.rows.empty()) return out;
  out += "<table>\n" + html_row(section.table.head, "th");
  for (const auto& row : section.table.rows) out += html_row(row, "td");
  return out + "</table>\n";
}

constexpr const char* kStyle =
    "body{font:15px/1.4 sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:.5em 0}td,th{padding:.2em .8em;border-bottom:1px solid #ddd;"
    "text-align:right}td:first-child,th:first-child{text-align:left}";

}  // namespace

std::string to_text(const Document& document, bool legend) {
  std::string out = document.headline + "\n";
  for (const Section& section : document.sections) {
    out += "\n";
    if (!section.title.empty()) out += section.title + "\n";
    for (const auto& line : section.lines) out += "  " + line + "\n";
    out += text_of(section.table, legend);
  }
  return out;
}

std::string to_html(const Document& document) {
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title>"
      "<style>{1}</style></head><body>\n<h1>{0}</h1>\n",
      escaped(document.headline), kStyle);
  for (const Section& section : document.sections) out += html_of(section);
  return out + "</body></html>\n";
}

}  // namespace odomcalib::cli
