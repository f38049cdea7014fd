#include "proto/recording/recording_log.hpp"

#include <fcntl.h>
#include <lcm/eventlog.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <system_error>

#include "proto/recording/recording.hpp"

namespace odomcalib {

struct RecordingLog::State {
  struct Close {
    void operator()(lcm_eventlog_t* open_log) const { lcm_eventlog_destroy(open_log); }
  };
  std::unique_ptr<lcm_eventlog_t, Close> log;
  std::filesystem::path path;
  std::string prefix;
  std::uint64_t bytes = 0;
  std::uint64_t events = 0;
};

namespace {

constexpr std::size_t kEventHeader = 28;
constexpr std::size_t kLongestLcmChannel = 63;

Error log_error(const std::string& what, const std::filesystem::path& path) {
  return {ErrorCode::io, what + ": " + std::generic_category().message(errno), path.string(),
          "check free space and permissions"};
}

}  // namespace

RecordingLog::RecordingLog(std::unique_ptr<State> state) : state_(std::move(state)) {}
RecordingLog::~RecordingLog() = default;
RecordingLog::RecordingLog(RecordingLog&&) noexcept = default;
RecordingLog& RecordingLog::operator=(RecordingLog&&) noexcept = default;

Result<RecordingLog> RecordingLog::create(const std::filesystem::path& path,
                                          const std::string& channel_prefix) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (fd < 0) return log_error("cannot create the recording", path);
  ::close(fd);
  auto state = std::make_unique<State>();
  state->log.reset(lcm_eventlog_create(path.c_str(), "w"));
  if (!state->log) return log_error("cannot open the recording", path);
  state->path = path;
  state->prefix = channel_prefix;
  return RecordingLog(std::move(state));
}

Result<void> RecordingLog::write(std::int64_t utime, const std::string& channel, std::string_view message) {
  if (channel.empty() || channel.size() > kLongestLcmChannel)
    return Error{ErrorCode::usage, "channel \"" + channel + "\" has not 1 to 63 characters",
                 state_->path.string(), "shorten channel_prefix or the sensor's name"};
  std::string name = channel;  // the C interface takes pointers to what it does not change
  std::string data(message);
  lcm_eventlog_event_t event{};
  event.eventnum = static_cast<std::int64_t>(state_->events);
  event.timestamp = utime;
  event.channellen = static_cast<std::int32_t>(name.size());
  event.datalen = static_cast<std::int32_t>(data.size());
  event.channel = name.data();
  event.data = data.data();
  if (lcm_eventlog_write_event(state_->log.get(), &event) != 0)
    return log_error("cannot write", state_->path);
  ++state_->events;
  state_->bytes += kEventHeader + name.size() + data.size();
  return {};
}

Result<void> RecordingLog::robot(std::int64_t utime, const RobotDescription& robot) {
  return write(utime, state_->prefix + "ROBOT", messages::encode(utime, robot));
}

Result<void> RecordingLog::ticks(const messages::Stamp& stamp, const TickSample& ticks,
                                 const messages::Origin& origin) {
  return write(stamp.utime, state_->prefix + "TICKS", messages::encode(stamp, ticks, origin));
}

Result<void> RecordingLog::scan(const messages::Stamp& stamp, const Scan& scan,
                                const messages::Origin& origin, bool complete) {
  return write(stamp.utime, scan_channel(state_->prefix, scan.sensor),
               messages::encode(stamp, scan, origin, complete));
}

Result<void> RecordingLog::pose(const messages::Stamp& stamp, const PoseSample& pose) {
  return write(stamp.utime, state_->prefix + "POSE_REF", messages::encode(stamp, pose));
}

Result<void> RecordingLog::gyro(const messages::Stamp& stamp, const GyroSample& gyro) {
  return write(stamp.utime, state_->prefix + "GYRO", messages::encode(stamp, gyro));
}

Result<void> RecordingLog::event(const messages::Stamp& stamp, messages::Severity severity,
                                 const std::string& code, const std::string& text) {
  return write(stamp.utime, state_->prefix + "EVENT", messages::encode_event(stamp, severity, code, text));
}

Result<void> RecordingLog::json(std::int64_t utime, const std::string& channel, const std::string& format,
                                const std::string& json) {
  return write(utime, state_->prefix + channel, messages::encode_json(utime, format, json));
}

Result<void> RecordingLog::flush(bool to_disk) {
  std::FILE* file = state_->log->f;
  if (std::fflush(file) != 0) return log_error("cannot write", state_->path);
  if (to_disk && ::fsync(::fileno(file)) != 0) return log_error("cannot sync", state_->path);
  return {};
}

std::uint64_t RecordingLog::bytes() const { return state_->bytes; }
std::uint64_t RecordingLog::events() const { return state_->events; }
const std::filesystem::path& RecordingLog::path() const { return state_->path; }

std::string scan_channel(const std::string& prefix, const std::string& sensor) {
  std::string out = prefix + "SCAN";
  if (sensor.empty()) return out;
  out += '_';
  for (const char c : sensor) {
    const char upper = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    out += (upper >= 'A' && upper <= 'Z') || (upper >= '0' && upper <= '9') ? upper : '_';
  }
  return out.substr(0, kLongestLcmChannel);
}

namespace {

messages::Stamp stamp_of(double t) {
  const auto ns = static_cast<std::int64_t>(std::llround(std::clamp(t, -9e9, 9e9) * 1e9));
  return {ns / 1000, ns};
}

Result<void> write_samples(const Recording& recording, RecordingLog& log) {
  const std::int64_t start = recording.ticks.empty() ? 0 : stamp_of(recording.ticks.front().t).utime;
  if (auto done = log.robot(start, recording.robot); !done) return done;
  messages::Origin origin;
  for (const auto& sample : recording.ticks) {
    if (auto done = log.ticks(stamp_of(sample.t), sample, origin); !done) return done;
    ++origin.seq;
  }
  origin.seq = 0;
  for (const auto& scan : recording.scans) {
    if (auto done = log.scan(stamp_of(scan.t), scan, origin); !done) return done;
    ++origin.seq;
  }
  for (const auto& sample : recording.poses)
    if (auto done = log.pose(stamp_of(sample.t), sample); !done) return done;
  for (const auto& sample : recording.gyro)
    if (auto done = log.gyro(stamp_of(sample.t), sample); !done) return done;
  return log.flush(true);
}

}  // namespace

Result<void> write_recording_log(const Recording& recording, const std::filesystem::path& path) {
  if (!recording.increments.empty())
    return Error{ErrorCode::usage, "increments of tuple files have no message", path.string(),
                 "keep the tuple file"};
  auto log = RecordingLog::create(path);
  if (!log) return log.error();
  return write_samples(recording, log.value());
}

}  // namespace odomcalib
