// The far end of a TCP connection on the loopback interface: a device that listens and serves one client.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "proto/result.hpp"

namespace odomcalib::sim {

class TcpPort {
 public:
  /// @param port 0: any free one
  static Result<std::unique_ptr<TcpPort>> open(std::uint16_t port = 0);
  ~TcpPort();
  TcpPort(const TcpPort&) = delete;
  TcpPort& operator=(const TcpPort&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// Takes a waiting client; a newer one replaces an older. True when a new one came.
  bool accept();
  /// Reads the bytes that the client sent; never blocks.
  std::string read();
  void write(const std::string& bytes);
  void drop_client();

 private:
  TcpPort(int listener, std::uint16_t port) : listener_(listener), port_(port) {}

  int listener_, client_ = -1;
  std::uint16_t port_;
};

}  // namespace odomcalib::sim
