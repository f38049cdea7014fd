#include "tests/sim/wires/tcp_port.hpp"

#include <arpa/inet.h>
#include <linux/sockios.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace odomcalib::sim {

Result<std::unique_ptr<TcpPort>> TcpPort::open(std::uint16_t port) {
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  const int on = 1;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  auto* plain = reinterpret_cast<sockaddr*>(&address);
  if (fd < 0 || ::bind(fd, plain, size) != 0 || ::listen(fd, 4) != 0 || getsockname(fd, plain, &size) != 0) {
    const Error error{ErrorCode::io, std::string("cannot listen: ") + std::strerror(errno), "127.0.0.1", ""};
    if (fd >= 0) ::close(fd);
    return error;
  }
  return std::unique_ptr<TcpPort>(new TcpPort(fd, ntohs(address.sin_port)));
}

TcpPort::~TcpPort() {
  drop_client();
  ::close(listener_);
}

void TcpPort::drop_client() {
  if (client_ >= 0) ::close(client_);
  client_ = -1;
}

bool TcpPort::accept() {
  const int fd = ::accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (fd < 0) return false;
  drop_client();
  client_ = fd;
  const int on = 1;
  setsockopt(client_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  return true;
}

std::string TcpPort::read() {
  std::string out;
  std::array<char, 4096> chunk{};
  for (ssize_t n = 0; client_ >= 0 && (n = ::recv(client_, chunk.data(), chunk.size(), 0)) > 0;)
    out.append(chunk.data(), static_cast<std::size_t>(n));
  return out;
}

void TcpPort::write(const std::string& bytes) {
  if (client_ < 0 || bytes.empty()) return;
  (void)!::send(client_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  // Simulated time runs faster than the kernel delivers: what was sent now must be there now.
  int waiting = 1;
  for (int i = 0; i < 2000 && ::ioctl(client_, SIOCOUTQNSD, &waiting) == 0 && waiting > 0; ++i) ::usleep(10);
}

}  // namespace odomcalib::sim
