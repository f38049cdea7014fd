// The far end of a serial port: the master of a pseudo-terminal. The program under test opens the slave by
// its path.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "proto/result.hpp"

namespace odomcalib::sim {

class Pty {
 public:
  static Result<std::unique_ptr<Pty>> open();
  ~Pty();
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// True while some program has the port open.
  [[nodiscard]] bool in_use() const;
  /// Reads the bytes that the program sent; never blocks.
  std::string read();
  /// Sends without blocking. Bytes that nobody listens to, or that do not fit, are lost, as on a real line.
  void write(std::span<const std::uint8_t> bytes);
  void write(const std::string& text);
  /// Bytes lost because the program did not read fast enough.
  [[nodiscard]] std::uint64_t overrun() const { return overrun_; }
  /// Makes `link` point to the port, replacing an older link.
  Result<void> link_as(const std::filesystem::path& link) const;

 private:
  Pty(int master, std::string path) : master_(master), path_(std::move(path)) {}

  int master_;
  std::string path_;
  std::uint64_t overrun_ = 0;
};

}  // namespace odomcalib::sim
