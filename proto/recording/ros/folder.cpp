#include "proto/recording/ros/folder.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "proto/file_bytes.hpp"
#include "proto/recording/ros/metadata.hpp"
#include "proto/recording/ros/unpack.hpp"

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

// Digits of the number of a split, so that what is counted on from it fits an int.
constexpr std::size_t kMostDigits = 9;

// The largest metadata.yaml that is looked at. Chosen: that of ten thousand splits and a thousand topics has
// 4 MiB.
constexpr std::uintmax_t kLargestMetadata_bytes = std::uintmax_t{16} << 20;

constexpr std::string_view kPacked = ".zstd";

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
  // rosbag2 writes no leading zeros, and nobody has a thousand million splits.
  if (error != std::errc() || end != digits.data() + digits.size() || std::to_string(number) != digits ||
      digits.size() > kMostDigits)
    return out;
  out.stem = base.substr(0, line + 1);
  out.number = number;
  return out;
}

/// "drive_12.db3", whether it is packed or not.
std::string unpacked_name(const Split& split) {
  const std::string name = split.name();
  return name.substr(0, name.size() - (name.ends_with(kPacked) ? kPacked.size() : 0));
}

/// Bytes that a packed file states to unpack to; 0: it does not state it, or cannot be read.
std::uintmax_t stated_size(const std::filesystem::path& packed) {
  std::string begin(kLongestFrameHeader, '\0');
  std::ifstream file(packed, std::ios::binary);
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(file.gcount()));
  return stated_by_frame(begin).value_or(0);
}

/// The plain one of a file and the same packed, unless it has fewer bytes than the packed one states. A
/// recorder that was killed while it packed leaves the first whole, an unpacking that was interrupted the
/// second.
const Split& whole_one(const Split& plain, const Split& packed) {
  std::error_code none;
  const auto size = std::filesystem::file_size(plain.path, none);
  return !none && size < stated_size(packed.path) ? packed : plain;
}

/// @return the files without those that are there in another form
Splits each_once(Splits files, std::vector<std::string>& remarks) {
  // A plain file comes before the same packed.
  std::sort(files.begin(), files.end(), [](const Split& a, const Split& b) {
    return std::pair(unpacked_name(a), a.name()) < std::pair(unpacked_name(b), b.name());
  });
  Splits out;
  for (const Split& file : files) {
    if (out.empty() || unpacked_name(out.back()) != unpacked_name(file)) {
      out.push_back(file);
      continue;
    }
    const Split plain = out.back();
    out.back() = whole_one(plain, file);
    const Split& other = out.back().path == plain.path ? file : plain;
    remarks.push_back(out.back().name() + " is read; " + other.name() + " is the same " +
                      (out.back().path == plain.path ? "packed, and is not" : "with less in it, and is not"));
  }
  return out;
}

/// The recording that a file is of: its stem and storage, with a slash as no file name has it, or its own
/// name.
std::string recording_of(const Split& split) {
  if (split.number < 0) return unpacked_name(split);
  return split.stem + "/" + split.ending.substr(0, split.ending.find('.', 1));
}

/// Splits that metadata.yaml lists of each recording, by number and name.
using Listed = std::map<std::string, std::map<int, std::string>>;

Listed listed_in(const std::filesystem::path& folder) {
  const auto path = folder / "metadata.yaml";
  std::error_code none;
  const auto size = std::filesystem::file_size(path, none);
  if (none || size > kLargestMetadata_bytes) return {};
  const auto text = read_file_bytes(path);
  Listed out;
  if (!text) return out;
  for (const std::string& name : files_listed(text.value())) {
    const Split split = split_of(name);
    if (split.number >= 0 && is_storage(split.ending)) out[recording_of(split)].emplace(split.number, name);
  }
  return out;
}

/// The number from which on nobody lists splits: rosbag2 counts from 0.
int first_unlisted(const Splits& splits, const Listed& listed) {
  const auto known = listed.find(recording_of(splits.front()));
  return known == listed.end() ? 0 : known->second.rbegin()->first + 1;
}

bool is_too_sparse(const Splits& splits, int from) {
  const auto behind = std::count_if(splits.begin(), splits.end(),
                                    [from](const Split& split) { return split.number >= from; });
  return splits.back().number - from - static_cast<int>(behind) >= kMostMissing;
}

std::vector<Splits> recordings_of(const Splits& files, const Listed& listed) {
  std::map<std::string, Splits> by_name;
  for (const Split& file : files) by_name[recording_of(file)].push_back(file);
  std::vector<Splits> out;
  for (auto& [name, splits] : by_name) {
    std::sort(splits.begin(), splits.end(), [](const Split& a, const Split& b) {
      return std::pair(a.number, a.path.filename()) < std::pair(b.number, b.path.filename());
    });
    if (!is_too_sparse(splits, first_unlisted(splits, listed))) {
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

/// Splits that are known to be missing: what metadata.yaml lists, and behind that what the numbers skip.
/// Without a list the splits before the first one are not known to have been kept.
void tell_missing(const Splits& splits, const Listed& listed, FolderFiles& out) {
  std::set<int> present;
  for (const Split& split : splits) present.insert(split.number);
  const auto known = listed.find(recording_of(splits.front()));
  const int first = splits.front().number;
  if (known != listed.end())
    for (const auto& [number, name] : known->second)
      if (!present.contains(number)) out.missing.push_back(name);
  if (known == listed.end() && first > 0)
    out.remarks.push_back("begins with " + splits.front().name() +
                          "; whether splits before it were kept is not known: no metadata.yaml lists them");
  int next = std::max(first_unlisted(splits, listed), known == listed.end() ? first : 0);
  for (const Split& split : splits) {
    for (; next < split.number; ++next)
      out.missing.push_back(split.stem + std::to_string(next) + split.ending);
    next = std::max(next, split.number + 1);
  }
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
  FolderFiles out;
  const Listed listed = listed_in(folder);
  const auto recordings = recordings_of(each_once(std::move(files), out.remarks), listed);
  if (recordings.size() > 1) return holds_several(recordings, folder);
  tell_missing(recordings.front(), listed, out);
  for (const Split& split : recordings.front()) out.files.push_back(split.path);
  return out;
}

}  // namespace odomcalib::ros
