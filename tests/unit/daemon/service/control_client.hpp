// The other end of the control socket, as a test needs it: bytes go out at once, answers are collected.
#pragma once

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "proto/control/control.hpp"

namespace odomcalib {

class ControlClient {
 public:
  explicit ControlClient(const std::filesystem::path& path)
      : fd_(socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.string().copy(address.sun_path, sizeof(address.sun_path) - 1);
    (void)!connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof(address));
  }
  ~ControlClient() { close(fd_); }
  ControlClient(const ControlClient&) = delete;
  ControlClient& operator=(const ControlClient&) = delete;

  /// @return bytes that the socket took
  std::size_t put(const std::string& bytes) const {
    const ssize_t written = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    return written > 0 ? static_cast<std::size_t>(written) : 0;
  }
  /// The same call so many times, in one write. @return bytes that the socket took
  std::size_t send(int times, const std::string& method) {
    const std::string one = control::encode_call({.method = std::string(control::kInterface) + "." + method});
    std::string all;
    for (int i = 0; i < times; ++i) all += one;
    return put(all);
  }
  std::size_t send_text(const std::string& json) { return put(json + std::string(1, '\0')); }
  std::vector<control::Reply> answers() {
    std::array<char, 65536> buffer{};
    for (ssize_t got = 0; (got = read(fd_, buffer.data(), buffer.size())) > 0;)
      decoder_.feed({buffer.data(), static_cast<std::size_t>(got)});
    std::vector<control::Reply> all;
    while (const auto frame = decoder_.next())
      if (const auto reply = control::decode_reply(*frame)) all.push_back(reply.value());
    return all;
  }

 private:
  int fd_;
  control::FrameDecoder decoder_;
};

}  // namespace odomcalib
