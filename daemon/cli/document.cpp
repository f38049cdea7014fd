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

}  // namespace odomcalib::cli
