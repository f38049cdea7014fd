// A file of the user's own that a verb changes: shown before, asked for, and the old one is kept.
#pragma once

#include <string>
#include <vector>

#include "daemon/cli/text_edit.hpp"
#include "proto/result.hpp"

namespace odomcalib::cli {

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
