#include "proto/recording/ros/folder.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>

namespace odomcalib::ros {
namespace {

/// "drive_12.db3.zstd" in its pieces; a name without a number has -1.
struct Split {
  std::filesystem::path path;
  std::string stem;    // "drive_"
  std::string ending;  // ".db3.zstd"
  int number = -1;
};

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
  const auto digits = name.find_last_not_of("0123456789", dot - 1) + 1;  // npos + 1 is 0
  out.stem = name.substr(0, digits);
  std::from_chars(name.data() + digits, name.data() + dot, out.number);
  return out;
}

/// rosbag2 counts from 0; a number that is left out is a file that was not copied along.
std::vector<std::string> missing_between(const std::vector<Split>& splits) {
  constexpr int kMostNamed = 1000;
  std::vector<std::string> missing;
  int next = 0;
  for (const Split& split : splits) {
    for (; split.number >= 0 && next < std::min(split.number, kMostNamed); ++next)
      missing.push_back(split.stem + std::to_string(next) + split.ending);
    next = std::max(next, split.number + 1);
  }
  return missing;
}

}  // namespace

Result<FolderFiles> files_of(const std::filesystem::path& folder) {
  std::vector<Split> splits;
  std::error_code failed;
  std::filesystem::directory_iterator entry(folder, failed);
  for (; !failed && entry != std::filesystem::directory_iterator(); entry.increment(failed)) {
    Split split = split_of(entry->path());
    if (is_storage(split.ending)) splits.push_back(std::move(split));
  }
  if (failed) return Error{ErrorCode::io, "cannot be listed: " + failed.message(), folder.string(), ""};
  if (splits.empty())
    return Error{ErrorCode::format, "is a folder without a rosbag2 recording (.db3 or .mcap)",
                 folder.string(), "name a recording, or the folder that ros2 bag record made"};
  std::sort(splits.begin(), splits.end(), [](const Split& a, const Split& b) {
    return std::pair(a.number, a.path.filename()) < std::pair(b.number, b.path.filename());
  });
  FolderFiles out;
  out.missing = missing_between(splits);
  for (const Split& split : splits) out.files.push_back(split.path);
  return out;
}

}  // namespace odomcalib::ros
