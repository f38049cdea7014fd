#include "daemon/cli/text_edit.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <system_error>

#include "proto/file_bytes.hpp"
#include "proto/number_text.hpp"

namespace odomcalib::cli {
namespace {

using Lines = std::vector<std::string_view>;

Lines lines_of(std::string_view text) {
  Lines lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// Length of the next stretch of both that differs: up to the first line from which on they agree again.
/// Texts that edits of single values made are in step soon.
std::pair<std::size_t, std::size_t> stretch(const Lines& before, std::size_t i, const Lines& after,
                                            std::size_t k) {
  for (std::size_t sum = 1;; ++sum)
    for (std::size_t gone = std::min(sum, before.size() - i) + 1; gone-- > 0;) {
      const std::size_t come = sum - gone;
      if (k + come > after.size()) break;
      const bool ends = i + gone == before.size() && k + come == after.size();
      const bool agrees =
          i + gone < before.size() && k + come < after.size() && before[i + gone] == after[k + come];
      if (ends || agrees) return {gone, come};
    }
}

std::string range(std::size_t from, std::size_t count) {
  // A range of no lines is named by the line before, as diff does.
  const std::size_t line = count == 0 ? from : from + 1;
  return count == 1 ? fmt::format("{}", line) : fmt::format("{},{}", line, count);
}

namespace fs = std::filesystem;

Result<void> replace_keeping_mode(const fs::path& path, const std::string& bytes, fs::perms mode) {
  if (auto written = replace_file(path, bytes); !written) return written;
  std::error_code error;
  fs::permissions(path, mode, error);
  if (!error) return {};
  return Error{ErrorCode::io, "cannot set the mode: " + error.message(), path.string(), "set it by hand"};
}

}  // namespace

std::string edited(std::string_view text, std::vector<TextEdit> edits) {
  std::stable_sort(edits.begin(), edits.end(),
                   [](const TextEdit& a, const TextEdit& b) { return a.at < b.at; });
  std::string out;
  std::size_t done = 0;
  for (const TextEdit& edit : edits) {
    out += text.substr(done, edit.at - done);
    out += edit.text;
    done = edit.at + edit.length;
  }
  return out += text.substr(done);
}

std::string diff_of(const std::string& name, std::string_view before_text, std::string_view after_text) {
  const Lines before = lines_of(before_text), after = lines_of(after_text);
  std::string out;
  for (std::size_t i = 0, k = 0; i < before.size() || k < after.size();) {
    if (i < before.size() && k < after.size() && before[i] == after[k]) {
      ++i;
      ++k;
      continue;
    }
    const auto [gone, come] = stretch(before, i, after, k);
    out += fmt::format("@@ -{} +{} @@\n", range(i, gone), range(k, come));
    for (const std::size_t end = i + gone; i < end; ++i) out += fmt::format("-{}\n", before[i]);
    for (const std::size_t end = k + come; k < end; ++k) out += fmt::format("+{}\n", after[k]);
  }
  return out.empty() ? out : fmt::format("--- {}~\n+++ {}\n", name, name) + out;
}

std::optional<double> number_in(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto number = number_from<double>(text);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

std::string real_text(double number) {
  std::string text = fmt::format("{}", number);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

std::size_t line_of(std::string_view text, std::size_t at) {
  const auto before = text.substr(0, at);
  return 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
}

std::string kept_name(const std::string& path) { return behind_links(path).string() + "~"; }

Result<void> ask_to_change(const std::string& path, bool yes) {
  if (yes) return {};
  if (isatty(STDIN_FILENO) != 1)
    return Error{ErrorCode::usage, "changing a file needs consent", path, "add --yes; nothing was written"};
  std::cerr << "Change " << path << " so? The old file is kept as " << kept_name(path)
            << ". Type yes to go on: " << std::flush;
  std::string answer;
  std::getline(std::cin, answer);
  if (answer == "yes") return {};
  return Error{ErrorCode::cancelled, "no consent", path, "nothing was written"};
}

Result<void> change_own_file(const std::string& path, const std::string& text,
                             const std::vector<TextEdit>& edits) {
  const auto now = read_file_bytes(path);
  if (!now) return now.error();
  if (now.value() != text)
    return Error{ErrorCode::busy, "was changed by somebody else meanwhile", path,
                 "try again; nothing was written"};
  std::error_code error;
  const auto status = fs::status(path, error);
  if (error || !fs::is_regular_file(status))
    return Error{ErrorCode::io, "is no regular file", path, "name a file; nothing was written"};
  if (auto kept = replace_keeping_mode(kept_name(path), text, status.permissions()); !kept) return kept;
  return replace_keeping_mode(behind_links(path), edited(text, edits), status.permissions());
}

}  // namespace odomcalib::cli
