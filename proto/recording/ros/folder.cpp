#include "proto/recording/ros/folder.hpp"

#include <algorithm>
#include <charconv>
#include <map>
#include <system_error>

namespace odomcalib::ros {
namespace {

/// "drive_12.db3.zstd" in its pieces; a name that rosbag2 does not write has -1 and no stem.
struct Split {
  std::filesystem::path path;
  std::string stem;    // "drive_"
  std::string ending;  // ".db3.zstd"
  int number = -1;

  [[nodiscard]] std::string name() const { return path.filename().string(); }
};

/// The files of one recording, in the order of its splits.
using Splits = std::vector<Split>;

// Splits that may be missing of one recording; beyond that the numbers are dates. Chosen: sixteen hours of
// splits of a minute.
constexpr int kMostMissing = 1000;

bool is_storage(const std::string& ending) {
  return ending == ".db3" || ending == ".mcap" || ending == ".db3.zstd" || ending == ".mcap.zstd";
}

Split split_of(const std::filesystem::path& path) {
  Split out;
  out.path = path;
  const std::string name = path.filename().string();
  auto dot = name.rfind('.');
  if (dot != std::string::npos && name.substr(dot) == ".zstd" && dot > 0) dot = name.rfind('.', dot - 1);
  if (dot == std::string::npos) return out;
  out.ending = name.substr(dot);
  const std::string base = name.substr(0, dot);
  const auto line = base.rfind('_');
  if (line == std::string::npos || line + 1 == base.size()) return out;
  const std::string digits = base.substr(line + 1);
  int number = -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  // rosbag2 writes no leading zeros.
  if (error != std::errc() || end != digits.data() + digits.size() || std::to_string(number) != digits)
    return out;
  out.stem = base.substr(0, line + 1);
  out.number = number;
  return out;
}

/// The recording that a file is of: its stem and storage, with a slash as no file name has it, or its own
/// name.
std::string recording_of(const Split& split) {
  if (split.number < 0) return split.name();
  return split.stem + "/" + split.ending.substr(0, split.ending.find('.', 1));
}

bool is_too_sparse(const Splits& splits) {
  return splits.back().number - static_cast<int>(splits.size()) >= kMostMissing;
}

std::vector<Splits> recordings_of(const Splits& files) {
  std::map<std::string, Splits> by_name;
  for (const Split& file : files) by_name[recording_of(file)].push_back(file);
  std::vector<Splits> out;
  for (auto& [name, splits] : by_name) {
    std::sort(splits.begin(), splits.end(), [](const Split& a, const Split& b) {
      return std::pair(a.number, a.path.filename()) < std::pair(b.number, b.path.filename());
    });
    if (!is_too_sparse(splits)) {
      out.push_back(std::move(splits));
      continue;
    }
    for (Split& file : splits) {
      file.number = -1;
      out.push_back({std::move(file)});
    }
  }
  return out;
}

/// rosbag2 counts from 0; a number that is left out is a file that was not copied along.
std::vector<std::string> missing_between(const Splits& splits) {
  std::vector<std::string> missing;
  int next = 0;
  for (const Split& split : splits) {
    for (; next < split.number; ++next) missing.push_back(split.stem + std::to_string(next) + split.ending);
    next = std::max(next, split.number + 1);
  }
  return missing;
}

Error holds_several(const std::vector<Splits>& recordings, const std::filesystem::path& folder) {
  constexpr std::size_t kMostListed = 12;
  const std::size_t listed = std::min(recordings.size(), kMostListed);
  std::string names;
  for (std::size_t i = 0; i < listed; ++i) {
    const Splits& one = recordings[i];
    names += (i > 0 ? ", " : "") + one.front().name();
    if (one.size() > 1) names += " to " + one.back().name();
  }
  if (listed < recordings.size()) names += " and " + std::to_string(recordings.size() - listed) + " more";
  return {ErrorCode::usage, "holds several recordings: " + names, folder.string(),
          "name one, or put the files of one into a folder of their own"};
}

}  // namespace

Result<FolderFiles> files_of(const std::filesystem::path& folder) {
  Splits files;
  std::error_code failed;
  std::filesystem::directory_iterator entry(folder, failed);
  for (; !failed && entry != std::filesystem::directory_iterator(); entry.increment(failed)) {
    Split split = split_of(entry->path());
    if (is_storage(split.ending)) files.push_back(std::move(split));
  }
  if (failed) return Error{ErrorCode::io, "cannot be listed: " + failed.message(), folder.string(), ""};
  if (files.empty())
    return Error{ErrorCode::format, "is a folder without a rosbag2 recording (.db3 or .mcap)",
                 folder.string(), "name a recording, or the folder that ros2 bag record made"};
  const auto recordings = recordings_of(files);
  if (recordings.size() > 1) return holds_several(recordings, folder);
  FolderFiles out;
  out.missing = missing_between(recordings.front());
  for (const Split& split : recordings.front()) out.files.push_back(split.path);
  return out;
}

}  // namespace odomcalib::ros
