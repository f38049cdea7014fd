#include "daemon/cli/text_layout.hpp"

#include <algorithm>
#include <numeric>
#include <sstream>

namespace odomcalib::cli {
namespace {

constexpr std::size_t kIndent = 2;  // columns before a row, and between two cells

// Columns of a terminal: every byte but the continuation bytes of UTF-8.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

std::size_t longest_word(const std::string& text) {
  std::size_t longest = 0;
  for (const std::string& word : words_of(text)) longest = std::max(longest, width_of(word));
  return longest;
}

/// As many words in a line as fit; at least one.
std::vector<std::string> filled(const std::string& text, std::size_t first, std::size_t others) {
  if (width_of(text) <= first) return {text};
  std::vector<std::string> lines;
  for (const std::string& word : words_of(text)) {
    const std::size_t room = lines.size() <= 1 ? first : others;
    if (!lines.empty() && width_of(lines.back()) + 1 + width_of(word) <= room)
      lines.back() += " " + word;
    else
      lines.push_back(word);
  }
  return lines;
}

bool is_number(const std::string& cell) {
  const std::size_t begin = cell.find_first_not_of("+-");
  return begin != std::string::npos && cell[begin] >= '0' && cell[begin] <= '9';
}

/// A table of the columns that were chosen of another, with the width of each.
struct Layout {
  const Table* table;
  std::vector<std::size_t> chosen;   ///< columns of the table
  std::vector<std::size_t> columns;  ///< width of each chosen one

  [[nodiscard]] std::size_t total() const {
    return std::accumulate(columns.begin(), columns.end(), kIndent * columns.size());
  }
};

std::string cell_of(const std::vector<std::string>& row, std::size_t column) {
  return column < row.size() ? row[column] : "";
}

std::size_t columns_of(const Table& table) {
  std::size_t columns = table.head.size();
  for (const auto& row : table.rows) columns = std::max(columns, row.size());
  return columns;
}

/// The largest that `measure` finds in the rows, and `head` in the head.
template <typename Head, typename Measure>
std::size_t widest(const Table& table, std::size_t column, Head head, Measure measure) {
  std::size_t width = head(cell_of(table.head, column));
  for (const auto& row : table.rows) width = std::max(width, measure(cell_of(row, column)));
  return width;
}

enum class Kind { words, label, numbers };

Kind kind_of(const Table& table, std::size_t column) {
  if (column == 0) return Kind::label;
  return is_of_numbers(table, column) ? Kind::numbers : Kind::words;
}

/// Takes from the widest columns of a kind what is more than their longest word, until all fit or no more can
/// be taken.
/// @param parts into which a cell may be broken
void narrow(Layout& layout, Kind kind, std::size_t parts, std::size_t width) {
  std::vector<std::size_t> least;
  for (std::size_t k = 0; k < layout.chosen.size(); ++k)
    least.push_back(kind_of(*layout.table, layout.chosen[k]) == kind
                        ? std::max(widest(*layout.table, layout.chosen[k], longest_word, longest_word),
                                   (layout.columns[k] + parts - 1) / parts)
                        : layout.columns[k]);
  while (layout.total() > width) {
    std::size_t widest_one = layout.columns.size();
    for (std::size_t k = 0; k < layout.columns.size(); ++k)
      if (layout.columns[k] > least[k] &&
          (widest_one == layout.columns.size() || layout.columns[k] > layout.columns[widest_one]))
        widest_one = k;
    if (widest_one == layout.columns.size()) return;
    --layout.columns[widest_one];
  }
}

/// Sentences are broken first, then heads, then what a row is of, and numbers last.
Layout layout_of(const Table& table, std::vector<std::size_t> chosen, std::size_t width) {
  constexpr std::size_t kHalves = 2, kWords = kAnyWidth / 2;
  Layout layout{&table, std::move(chosen), {}};
  for (const std::size_t column : layout.chosen)
    layout.columns.push_back(widest(table, column, width_of, width_of));
  narrow(layout, Kind::words, kWords, width);
  if (layout.total() <= width) return layout;
  for (std::size_t k = 0; k < layout.chosen.size(); ++k)
    layout.columns[k] = widest(table, layout.chosen[k], longest_word, width_of);
  narrow(layout, Kind::words, kWords, width);
  narrow(layout, Kind::label, kHalves, width);
  narrow(layout, Kind::numbers, kWords, width);
  narrow(layout, Kind::label, kWords, width);
  return layout;
}

std::string row_text(const Layout& layout, const std::vector<std::string>& row, bool from_below) {
  std::vector<std::vector<std::string>> cells;
  std::size_t height = 1;
  for (std::size_t k = 0; k < layout.chosen.size(); ++k) {
    cells.push_back(filled(cell_of(row, layout.chosen[k]), layout.columns[k], layout.columns[k]));
    height = std::max(height, cells.back().size());
  }
  std::string out;
  for (std::size_t line = 0; line < height; ++line) {
    std::string text;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const std::size_t above = from_below ? height - cells[k].size() : 0;
      const std::string part = line >= above && line - above < cells[k].size() ? cells[k][line - above] : "";
      const std::string pad(layout.columns[k] - std::min(layout.columns[k], width_of(part)), ' ');
      text += std::string(kIndent, ' ') +
              (is_of_numbers(*layout.table, layout.chosen[k]) ? pad + part : part + pad);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out += text + "\n";
  }
  return out;
}

std::string block_text(const Layout& layout, bool legend) {
  std::string out;
  if (legend && !layout.table->head.empty()) out += row_text(layout, layout.table->head, true);
  for (const auto& row : layout.table->rows) out += row_text(layout, row, false);
  return out;
}

}  // namespace

bool is_of_numbers(const Table& table, std::size_t column) {
  std::size_t numbers = 0, others = 0;
  for (const auto& row : table.rows) {
    const std::string cell = cell_of(row, column);
    if (is_number(cell))
      ++numbers;
    else if (cell.find_first_not_of(" ->") != std::string::npos)
      ++others;
  }
  return column > 0 && numbers > 0 && numbers >= others;
}

std::string wrapped(const std::string& text, std::size_t width) {
  const std::size_t own = std::min(text.find_first_not_of(' '), text.size());
  const std::string indent(own, ' '), further(own + 4, ' ');
  const auto room = [&](std::size_t taken) { return width > taken ? width - taken : 1; };
  std::string out;
  for (const std::string& line : filled(text.substr(own), room(own), room(own + 4)))
    out += (out.empty() ? indent : further) + line + "\n";
  return out.empty() ? "\n" : out;
}

std::string wrapped_command(const std::string& command, std::size_t width) {
  if (width_of(command) <= width) return command + "\n";
  std::string out = wrapped(command, width > 2 ? width - 2 : 1);
  for (std::size_t end = out.find('\n'); end + 1 < out.size(); end = out.find('\n', end + 3))
    out.insert(end, " \\");
  return out;
}

std::string wrapped_message(const std::string& text, std::size_t width) {
  if (width_of(text) <= width) return text + "\n";
  const std::string indent(4, ' '), command = ": odomcalibctl ";
  std::string out;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find("; ", from), text.size());
    const std::string part = (from == 0 ? "" : indent) + text.substr(from, end - from);
    const std::size_t typed = width_of(part) > width ? part.find(command) : std::string::npos;
    out += wrapped(typed == std::string::npos ? part : part.substr(0, typed + 1), width);
    if (typed != std::string::npos) out += wrapped_command(indent + part.substr(typed + 2), width);
    from = end + 2;
  }
  return out;
}

std::string laid_out(const Table& table, bool legend, std::size_t width) {
  std::vector<std::size_t> rest(columns_of(table));
  std::iota(rest.begin(), rest.end(), std::size_t{0});
  std::string out;
  while (!rest.empty()) {
    std::vector<std::size_t> chosen = rest;
    Layout layout = layout_of(table, chosen, width);
    while (layout.total() > width && chosen.size() > 2) {
      chosen.pop_back();
      layout = layout_of(table, chosen, width);
    }
    out += (out.empty() ? "" : "\n") + block_text(layout, legend);
    if (chosen.size() == rest.size()) break;
    // The first column says what a row is of, in every block.
    rest.erase(rest.begin() + 1, rest.begin() + static_cast<std::ptrdiff_t>(chosen.size()));
  }
  return out;
}

}  // namespace odomcalib::cli
