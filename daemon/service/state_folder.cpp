#include "daemon/service/state_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace odomcalib {

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

}  // namespace odomcalib
