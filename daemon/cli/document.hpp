// A result as headings, lines, tables and figures, rendered as text or as parts of an HTML page: the two
// cannot disagree.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "daemon/cli/text_layout.hpp"

namespace odomcalib::cli {

/// One curve of a figure; the tone shows what it stands for, in every figure the same.
struct Curve {
  enum class Style { line, dots, steps };
  enum class Tone { before, after, reference };
  std::string label;
  Style style = Style::line;
  Tone tone = Tone::after;
  std::vector<std::array<double, 2>> points;
  std::vector<double> errors = {};  ///< half widths of vertical bars, one a point, or none
};

struct Figure {
  std::string caption;
  std::string x_label, y_label;
  bool equal_scales = false;  ///< a map: a metre is a metre both ways
  std::vector<Curve> curves;
};

struct Section {
  std::string title;  ///< empty: no heading
  std::vector<std::string> lines;
  Table table;
  std::vector<Figure> figures = {};  ///< in HTML only: whatever they show is said in lines or table too
};

struct Document {
  /// How good the news in the headline is; a page shows it as a colour too.
  enum class Tone { plain, good, doubtful, bad };
  std::string headline;
  std::vector<Section> sections;
  Tone tone = Tone::plain;
};

/// @param legend whether tables show their head
/// @param width columns of a line
std::string to_text(const Document& document, bool legend = true, std::size_t width = kAnyWidth);
// A page is self-contained, without scripts, readable on light and on dark screens; texts are escaped.
std::string html_of(const Section& section);
std::string html_of(const Table& table);
/// Empty where there is nothing to draw.
std::string html_of(const Figure& figure);
/// Name of the style's class.
const char* class_of(Document::Tone tone);
/// @param style what the page has beyond the common style
std::string page_of(const std::string& title, const std::string& style, const std::string& body);
/// All sections below the headline.
std::string page_of(const Document& document);

}  // namespace odomcalib::cli
