#include "tests/sim/wires/pty.hpp"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace odomcalib::sim {

namespace {

Error failed(const std::string& what) {
  return {ErrorCode::io, what + ": " + std::strerror(errno), "/dev/ptmx", "is /dev/pts mounted?"};
}

/// No echo, no line editing, 8 bits: what is written comes out unchanged.
bool make_raw(int fd) {
  termios settings{};
  if (tcgetattr(fd, &settings) != 0) return false;
  cfmakeraw(&settings);
  return tcsetattr(fd, TCSANOW, &settings) == 0;
}

}  // namespace

Result<std::unique_ptr<Pty>> Pty::open() {
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (master < 0) return failed("cannot open a pseudo-terminal");
  std::array<char, 64> name{};
  const bool usable = ::grantpt(master) == 0 && ::unlockpt(master) == 0 &&
                      ::ptsname_r(master, name.data(), name.size()) == 0 && make_raw(master);
  // Opening and closing once makes the kernel report from now on whether somebody has the port open.
  const int slave = usable ? ::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC) : -1;
  if (slave < 0) {
    const Error error = failed("cannot set up a pseudo-terminal");
    ::close(master);
    return error;
  }
  ::close(slave);
  return std::unique_ptr<Pty>(new Pty(master, name.data()));
}

Pty::~Pty() { ::close(master_); }

bool Pty::in_use() const {
  pollfd state{master_, POLLIN, 0};
  return ::poll(&state, 1, 0) >= 0 && (state.revents & POLLHUP) == 0;
}

std::string Pty::read() {
  std::string out;
  std::array<char, 4096> chunk{};
  for (;;) {
    const ssize_t count = ::read(master_, chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return out;
    out.append(chunk.data(), static_cast<std::size_t>(count));
  }
}

void Pty::write(std::span<const std::uint8_t> bytes) {
  if (bytes.empty() || !in_use()) return;
  while (!bytes.empty()) {
    const ssize_t count = ::write(master_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  overrun_ += bytes.size();
}

void Pty::write(const std::string& text) {
  write(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

Result<void> Pty::link_as(const std::filesystem::path& link) const {
  std::error_code error;
  if (link.has_parent_path()) std::filesystem::create_directories(link.parent_path(), error);
  const std::filesystem::path fresh = link.string() + ".new";
  std::filesystem::remove(fresh, error);
  std::filesystem::create_symlink(path_, fresh, error);
  if (!error) std::filesystem::rename(fresh, link, error);
  if (error) return Error{ErrorCode::io, "cannot make the link: " + error.message(), link.string(), ""};
  return {};
}

}  // namespace odomcalib::sim
