// A result as headings, lines and tables, rendered as text or as one HTML page: the two cannot disagree.
#pragma once

#include <string>
#include <vector>

namespace odomcalib::cli {

struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;  ///< first column left-aligned, the others right-aligned
};

struct Section {
  std::string title;  ///< empty: no heading
  std::vector<std::string> lines;
  Table table;
};

struct Document {
  std::string headline;
  std::vector<Section> sections;
};

/// @param legend whether tables show their head
std::string to_text(const Document& document, bool legend = true);
/// Self-contained page without scripts; texts are escaped.
std::string to_html(const Document& document);

}  // namespace odomcalib::cli
