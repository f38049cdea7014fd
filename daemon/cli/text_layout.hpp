// Text that fits so many columns: sentences are broken between words, tables in their heads, then in their
// cells, and at last into blocks of columns.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace odomcalib::cli {

struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};

/// At least half of what is there; what is absent ("-") counts for neither. The first column says what a row
/// is of: it never is.
bool is_of_numbers(const Table& table, std::size_t column);

/// No text is broken.
inline constexpr std::size_t kAnyWidth = static_cast<std::size_t>(-1);

/// Lines of a text, each with its line end. A word that is longer than a line stays whole, so that a path can
/// be copied. Lines after the first are indented by four more columns than the text is itself.
std::string wrapped(const std::string& text, std::size_t width);

/// A command, broken so that a shell still takes it as one.
std::string wrapped_command(const std::string& command, std::size_t width);

/// A message, of sentences that are joined by "; " and may end with ": odomcalibctl ...". It stays on one
/// line where that fits; else each sentence begins a line, and so does a command, which a shell still takes
/// as it stands.
std::string wrapped_message(const std::string& text, std::size_t width);

/// Numbers are right-aligned, everything else and the first column left-aligned.
/// @param legend whether the head is shown
std::string laid_out(const Table& table, bool legend, std::size_t width);

}  // namespace odomcalib::cli
