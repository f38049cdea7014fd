// Changes to a text that somebody else wrote: everything that is not changed stays as it is, byte for byte.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/result.hpp"

namespace odomcalib::cli {

/// A stretch of a text and its replacement.
struct TextEdit {
  std::size_t at = 0, length = 0;  ///< bytes
  std::string text;
};

/// Edits may come in any order; they lie within the text and not on each other.
std::string edited(std::string_view text, std::vector<TextEdit> edits);

/// As `diff -U0` prints it, for people. Two texts that are equal give nothing.
std::string diff_of(const std::string& name, std::string_view before, std::string_view after);

/// Finite, written out in whole; nullopt: not a number, or one with something beside it.
std::optional<double> number_in(std::string_view text);

/// The shortest text that reads back to the same number, and is no whole number to YAML: 1.0.
std::string real_text(double number);

/// Line of a byte of the text, from 1.
std::size_t line_of(std::string_view text, std::size_t at);

/// Where the old file is kept: beside it, with a tilde, over what was kept there before.
std::string kept_name(const std::string& path);

/// Whether a person agrees to the change. Asks on a terminal; without one, and without `yes`, nobody does.
/// Errors: usage (nobody to ask), cancelled.
Result<void> ask_to_change(const std::string& path, bool yes);

/// Writes what the edits make of the text; the file keeps its mode, and a link stays one. What was there is
/// kept under `kept_name` first. Errors: io; busy, where the file is no longer the text.
Result<void> change_own_file(const std::string& path, const std::string& text,
                             const std::vector<TextEdit>& edits);

}  // namespace odomcalib::cli
