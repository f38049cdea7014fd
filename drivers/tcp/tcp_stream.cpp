#include "drivers/tcp/tcp_stream.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "drivers/settings.hpp"
#include "drivers/tcp/host_lookup.hpp"

namespace odomcalib::drivers {
namespace {

Error net_error(const std::string& address, const std::string& what) {
  return {ErrorCode::device, what, address,
          "check power, cable and address: ping the device; it is connected to again by itself"};
}

class TcpStream final : public ByteStream {
 public:
  TcpStream(std::string address, int fd) : address_(std::move(address)), fd_(fd) {}
  ~TcpStream() override { ::close(fd_); }
  TcpStream(const TcpStream&) = delete;
  TcpStream& operator=(const TcpStream&) = delete;

  [[nodiscard]] int fd() const override { return fd_; }

  Result<bool> connected() override {
    if (connected_) return true;
    pollfd state{fd_, POLLOUT, 0};
    if (::poll(&state, 1, 0) <= 0) return false;
    int error = 0;
    socklen_t size = sizeof(error);
    if (getsockopt(fd_, SOL_SOCKET, SO_ERROR, &error, &size) != 0) error = errno;
    if (error != 0) return net_error(address_, std::string("cannot connect: ") + std::strerror(error));
    return connected_ = true;
  }

  Result<std::vector<std::uint8_t>> read() override {
    std::vector<std::uint8_t> out;
    std::array<std::uint8_t, 4096> chunk{};
    while (out.size() < kReadAtMost) {
      const ssize_t n = ::recv(fd_, chunk.data(), chunk.size(), 0);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) break;
      if (n <= 0 && !out.empty()) break;  // told at the next call
      if (n == 0) return net_error(address_, "the device closed the connection");
      if (n < 0) return net_error(address_, std::string("connection lost: ") + std::strerror(errno));
      out.insert(out.end(), chunk.begin(), chunk.begin() + n);
      if (static_cast<std::size_t>(n) < chunk.size()) break;  // that was all
    }
    return out;
  }

  Result<void> write(std::span<const std::uint8_t> bytes) override {
    while (!bytes.empty()) {
      const ssize_t n = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
        return net_error(address_, "the device does not take what is sent");
      if (n < 0) return net_error(address_, std::string("connection lost: ") + std::strerror(errno));
      bytes = bytes.subspan(static_cast<std::size_t>(n));
    }
    return {};
  }

 private:
  std::string address_;
  int fd_;
  bool connected_ = false;
};

/// No delay for the short requests; a dead peer is noticed even while nothing is sent.
void set_tcp_options(int fd) {
  const int on = 1;
  setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  setsockopt(fd, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof(on));
}

}  // namespace

Result<std::unique_ptr<ByteStream>> open_tcp(const std::string& address) {
  const HostAndPort parts = split(address);
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (parts.host.empty() || getaddrinfo(parts.host.c_str(), parts.port.c_str(), &hints, &found) != 0)
    return Error{ErrorCode::usage, "not a numeric address with a port", address,
                 "write it like tcp:192.168.0.10:2112"};
  const int fd = ::socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const bool begun =
      fd >= 0 && (::connect(fd, found->ai_addr, found->ai_addrlen) == 0 || errno == EINPROGRESS);
  const int cause = errno;
  freeaddrinfo(found);
  if (!begun) {
    if (fd >= 0) ::close(fd);
    return net_error(address, std::string("cannot connect: ") + std::strerror(cause));
  }
  set_tcp_options(fd);
  return std::unique_ptr<ByteStream>(std::make_unique<TcpStream>(address, fd));
}

}  // namespace odomcalib::drivers
