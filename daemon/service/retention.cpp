#include "daemon/service/retention.hpp"

#include <algorithm>
#include <map>

namespace odomcalib {
namespace {

namespace fs = std::filesystem;

struct Group {
  std::vector<fs::path> files;
  std::uintmax_t bytes = 0;
  fs::file_time_type newest = fs::file_time_type::min();
};

std::map<std::string, Group> groups_in(const fs::path& folder) {
  std::map<std::string, Group> groups;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code gone;
    if (!it->is_regular_file(gone) || it->is_symlink(gone)) continue;
    Group& group = groups[it->path().stem().string()];
    const auto bytes = it->file_size(gone);
    group.files.push_back(it->path());
    group.bytes += gone ? 0 : bytes;
    group.newest = std::max(group.newest, it->last_write_time(gone));
  }
  return groups;
}

}  // namespace

std::vector<std::string> keep_newest(const fs::path& folder, const Retention& retention) {
  const auto groups = groups_in(folder);
  std::vector<const std::pair<const std::string, Group>*> by_age;
  by_age.reserve(groups.size());
  for (const auto& group : groups) by_age.push_back(&group);
  std::stable_sort(by_age.begin(), by_age.end(),
                   [](const auto* a, const auto* b) { return a->second.newest > b->second.newest; });
  std::vector<std::string> removed;
  std::uintmax_t bytes = 0;
  for (std::size_t i = 0; i < by_age.size(); ++i) {
    const auto& [name, group] = *by_age[i];
    bytes += group.bytes;
    if (i == 0 || (i < retention.most && bytes <= retention.most_bytes)) continue;
    std::error_code passed_over;
    for (const fs::path& file : group.files) fs::remove(file, passed_over);
    removed.push_back(name);
  }
  return removed;
}

}  // namespace odomcalib
