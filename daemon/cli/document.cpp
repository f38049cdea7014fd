#include "daemon/cli/document.hpp"

namespace odomcalib::cli {

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

}  // namespace odomcalib::cli
