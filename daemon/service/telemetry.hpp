// What leaves the daemon without being asked for: LCM messages and recordings, the same bytes for both.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>

#include "drivers/can/transport.hpp"
#include "proto/messages.hpp"
#include "proto/recording_log.hpp"

namespace odomcalib {

/// Sends over LCM. Without a network, a route or a working URL it counts and does nothing: telemetry never
/// delays or stops the service.
class Publisher {
 public:
  /// @param url empty: publish nothing
  Publisher(const std::string& url, std::string prefix);
  ~Publisher();
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;
  /// @param channel without prefix
  void send(const std::string& channel, const std::string& message);
  [[nodiscard]] std::uint64_t sent() const { return sent_; }
  [[nodiscard]] std::uint64_t failed() const { return failed_; }
  [[nodiscard]] const std::string& prefix() const { return prefix_; }

 private:
  struct Handle;
  std::unique_ptr<Handle> lcm_;
  std::string prefix_;
  std::uint64_t sent_ = 0, failed_ = 0;
};

/// The recording in progress, if any, bounded in size.
class Recorder {
 public:
  explicit Recorder(std::filesystem::path folder, std::string prefix)
      : folder_(std::move(folder)), prefix_(std::move(prefix)) {}
  /// Starts a file <name>.lcmlog in the folder; the name gets a number when it exists. Errors: io (also too
  /// little space), usage (name).
  Result<std::filesystem::path> start(const std::string& name);
  void write(std::int64_t utime, const std::string& channel, const std::string& message);
  /// A frame on the bus goes into a candump log of the same name beside the recording; canplayer sends it
  /// again.
  void write_frame(std::int64_t utime, const drivers::CanFrame& frame);
  /// Syncs and closes. @return path of the finished file. Error: io, when anything could not be written.
  Result<std::filesystem::path> finish();
  [[nodiscard]] bool active() const { return log_.has_value(); }
  [[nodiscard]] std::uint64_t bytes() const { return log_ ? log_->bytes() : 0; }

 private:
  std::filesystem::path folder_;
  std::string prefix_;
  std::optional<RecordingLog> log_;
  std::ofstream frames_;
  std::uint64_t frame_bytes_ = 0;
  std::optional<Error> problem_;
};

/// Both at once.
class Telemetry {
 public:
  Telemetry(const std::string& lcm_url, const std::string& prefix, std::filesystem::path recordings)
      : publisher(lcm_url, prefix), recorder(std::move(recordings), prefix) {}
  void emit(std::int64_t utime, const std::string& channel, const std::string& message) {
    publisher.send(channel, message);
    recorder.write(utime, channel, message);
  }
  Publisher publisher;
  Recorder recorder;
};

}  // namespace odomcalib
