#include "daemon/cli/own_file.hpp"

#include <unistd.h>

#include <filesystem>
#include <iostream>
#include <system_error>

#include "proto/file_bytes.hpp"

namespace odomcalib::cli {
namespace {

namespace fs = std::filesystem;

Result<void> replace_keeping_mode(const fs::path& path, const std::string& bytes, fs::perms mode) {
  if (auto written = replace_file(path, bytes); !written) return written;
  std::error_code error;
  fs::permissions(path, mode, error);
  if (!error) return {};
  return Error{ErrorCode::io, "cannot set the mode: " + error.message(), path.string(), "set it by hand"};
}

}  // namespace

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
