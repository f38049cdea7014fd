// A recording while it is being made: an LCM event log that the daemon writes directly, without the detour
// over UDP.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "proto/measurements.hpp"
#include "proto/result.hpp"
#include "proto/wire/messages.hpp"

namespace odomcalib {

/// Not thread-safe: one writer. The file can be read with read_recording at any time; what was not flushed
/// yet may be missing or cut off, which readers tolerate.
class RecordingLog {
 public:
  /// Creates the file; an existing one is not overwritten. Error: io.
  /// @param channel_prefix as in the daemon's configuration
  static Result<RecordingLog> create(const std::filesystem::path& path,
                                     const std::string& channel_prefix = "ODOMCALIB_");
  ~RecordingLog();
  RecordingLog(RecordingLog&&) noexcept;
  RecordingLog& operator=(RecordingLog&&) noexcept;

  // Each writes one event. Error: io (disk full); the log stays usable, the event may be cut off.
  Result<void> robot(std::int64_t utime, const RobotDescription& robot);
  Result<void> ticks(const messages::Stamp& stamp, const TickSample& ticks,
                     const messages::Origin& origin = {});
  Result<void> scan(const messages::Stamp& stamp, const Scan& scan, const messages::Origin& origin = {},
                    bool complete = true);
  Result<void> pose(const messages::Stamp& stamp, const PoseSample& pose);
  Result<void> gyro(const messages::Stamp& stamp, const GyroSample& gyro);
  Result<void> event(const messages::Stamp& stamp, messages::Severity severity, const std::string& code,
                     const std::string& text);
  /// @param channel without prefix: STATUS, PROGRESS or RESULT
  Result<void> json(std::int64_t utime, const std::string& channel, const std::string& format,
                    const std::string& json);

  /// Bytes that were encoded already, for publishing.
  /// @param channel whole name, 1 to 63 characters
  Result<void> write(std::int64_t utime, const std::string& channel, std::string_view message);

  /// Hands everything to the kernel; with `to_disk` also to the disk.
  Result<void> flush(bool to_disk = false);

  [[nodiscard]] std::uint64_t bytes() const;   ///< written so far, for a limit on size
  [[nodiscard]] std::uint64_t events() const;  ///< written so far
  [[nodiscard]] const std::filesystem::path& path() const;

 private:
  struct State;
  explicit RecordingLog(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The channel of a scan: SCAN, or SCAN_name for a named sensor (upper case, other characters than A-Z, 0-9
/// become "_").
std::string scan_channel(const std::string& prefix, const std::string& sensor);

struct Recording;
/// Writes a whole recording as an event log: t becomes mono_ns (rounded to 1 ns), utime is the same instant
/// in us. Increments of tuple files have no message and make this fail (error: usage).
Result<void> write_recording_log(const Recording& recording, const std::filesystem::path& path);

}  // namespace odomcalib
