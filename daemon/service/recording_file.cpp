#include "daemon/service/recording_file.hpp"

#include <spdlog/spdlog.h>

#include <fstream>
#include <limits>
#include <optional>

#include "daemon/service/state_folder.hpp"
#include "proto/recording/recording_log.hpp"

namespace odomcalib {
namespace {

class RecordingFile final : public RecordingSink {
 public:
  RecordingFile(std::filesystem::path path, std::string prefix, std::uintmax_t most_bytes)
      : path_(std::move(path)), prefix_(std::move(prefix)), most_bytes_(most_bytes) {}

  Result<void> open() override {
    const Retention retention{most_bytes_, std::numeric_limits<std::size_t>::max()};
    for (const std::string& name : keep_newest(path_.parent_path(), retention))
      spdlog::info("recordings: {} was removed, daemon.keep_recordings is reached", name);
    auto log = RecordingLog::create(path_, prefix_);
    if (!log) return log.error();
    log_.emplace(std::move(log).value());
    return {};
  }

  Result<void> write(const RecordedItem& item) override {
    return item.channel.empty() ? write_line(item.bytes) : log_->write(item.utime, item.channel, item.bytes);
  }

  Result<void> finish() override {
    if (frames_.is_open()) frames_.close();
    if (frames_.fail()) return cannot_write_frames();
    return log_->flush(true);
  }

 private:
  [[nodiscard]] std::filesystem::path frames_path() const {
    return std::filesystem::path(path_).replace_extension(".candump");
  }

  [[nodiscard]] Error cannot_write_frames() const {
    return {ErrorCode::io, "cannot write the frames on the bus", frames_path().string(),
            "check free space and permissions"};
  }

  Result<void> write_line(const std::string& line) {
    if (!frames_.is_open()) frames_.open(frames_path(), std::ios::trunc);
    frames_ << line;
    if (!frames_) return cannot_write_frames();
    return {};
  }

  std::filesystem::path path_;
  std::string prefix_;
  std::uintmax_t most_bytes_;
  std::optional<RecordingLog> log_;
  std::ofstream frames_;
};

}  // namespace

std::unique_ptr<RecordingSink> recording_file(const std::filesystem::path& path,
                                              const std::string& channel_prefix, std::uintmax_t most_bytes) {
  return std::make_unique<RecordingFile>(path, channel_prefix, most_bytes);
}

}  // namespace odomcalib
