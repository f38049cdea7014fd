// Unrequested output of the daemon: LCM messages and recordings, the same bytes for both.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/service/publisher.hpp"
#include "daemon/service/recording_file.hpp"
#include "daemon/service/recording_writer.hpp"
#include "daemon/service/settings.hpp"
#include "drivers/can/transport.hpp"
#include "proto/wire/messages.hpp"

namespace odomcalib {

/// The recording in progress, if any, bounded in size, and those whose end is still being written. Belongs to
/// the loop and never waits for a disk; who asks learns of the end from serve().
class Recorder {
 public:
  using Done = std::function<void(const Result<std::filesystem::path>&)>;
  using MakeSink = std::function<std::unique_ptr<RecordingSink>(const std::filesystem::path&,
                                                                const std::string& channel_prefix)>;
  static constexpr std::size_t kMostUnfinished = service::settings::kMostUnfinished;

  Recorder(std::filesystem::path folder, std::string prefix, MakeSink make_sink);
  /// Starts a file <name>.lcmlog in the folder; the name gets a number when it exists. Errors: io (too little
  /// space, or older recordings are still being written), usage (name). That the file cannot be made shows in
  /// problem().
  Result<std::filesystem::path> start(const std::string& name);
  void write(std::int64_t utime, const std::string& channel, const std::string& message);
  /// A frame on the bus goes into a candump log of the same name beside the recording; canplayer sends it
  /// again.
  void write_frame(std::int64_t utime, const drivers::CanFrame& frame);
  /// Ends the recording in progress. @param done called by serve() once it is on the disk, with its path or
  /// with the error (io) when anything could not be written; may be empty
  void finish(Done done);
  void serve();
  /// Why what is written now does not reach the disk: there is no use in going on.
  [[nodiscard]] std::optional<Error> problem() const;
  [[nodiscard]] bool active() const { return current_.has_value(); }
  /// Ended, not yet on the disk.
  [[nodiscard]] bool finishing() const { return !ending_.empty(); }
  [[nodiscard]] std::uint64_t bytes() const { return current_ ? current_->bytes : 0; }
  [[nodiscard]] std::size_t bytes_waiting() const { return current_ ? current_->writer->bytes_waiting() : 0; }

 private:
  struct Job {
    std::filesystem::path path;
    std::unique_ptr<RecordingWriter> writer;
    std::uint64_t bytes = 0, frame_bytes = 0;
    std::optional<Error> problem;
    Done done;
    [[nodiscard]] std::optional<Error> first_problem() const { return problem ? problem : writer->problem(); }
  };
  [[nodiscard]] std::filesystem::path free_path(const std::string& name) const;
  void push(RecordedItem item);

  std::filesystem::path folder_;
  std::string prefix_;
  MakeSink make_sink_;
  std::optional<Job> current_;
  std::vector<Job> ending_;
};

/// Both at once.
class Telemetry {
 public:
  /// @param most_bytes of recordings that are kept
  Telemetry(const std::string& lcm_url, const std::string& prefix, std::filesystem::path recordings,
            std::uintmax_t most_bytes)
      : publisher(lcm_url, prefix),
        recorder(std::move(recordings), prefix, [most_bytes](const auto& path, const auto& channel_prefix) {
          return recording_file(path, channel_prefix, most_bytes);
        }) {}
  void emit(std::int64_t utime, const std::string& channel, const std::string& message) {
    publisher.send(channel, message);
    recorder.write(utime, channel, message);
  }
  Publisher publisher;
  Recorder recorder;
};

}  // namespace odomcalib
