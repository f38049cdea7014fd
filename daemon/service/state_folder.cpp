#include "daemon/service/state_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <utility>

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

Result<StateFolder> StateFolder::open(const std::filesystem::path& path) {
  StateFolder folder;
  std::error_code ignored;  // shows in the opening
  std::filesystem::create_directories(path, ignored);
  folder.lock_ = ::open((path / "lock").c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0640);
  if (folder.lock_ < 0) {
    folder.read_only_ =
        Error{ErrorCode::io, std::string("nothing can be written: ") + std::strerror(errno), path.string(),
              "give it to the daemon's user, on a file system that is not read-only"};
    return folder;
  }
  if (flock(folder.lock_, LOCK_EX | LOCK_NB) == 0) return folder;
  return Error{ErrorCode::io, "another daemon uses this state directory", path.string(),
               "stop it, or give this one a state_dir of its own"};
}

StateFolder::~StateFolder() {
  if (lock_ >= 0) close(lock_);
}

StateFolder::StateFolder(StateFolder&& other) noexcept
    : lock_(std::exchange(other.lock_, -1)), read_only_(std::move(other.read_only_)) {}

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
