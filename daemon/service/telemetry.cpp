#include "daemon/service/telemetry.hpp"

#include <fmt/format.h>
#include <lcm/lcm.h>

#include <algorithm>
#include <cctype>

#include "drivers/can/candump.hpp"

namespace odomcalib {
namespace {

constexpr std::uint64_t kLargestRecording = std::uint64_t{512} << 20;
constexpr std::uintmax_t kLeastSpace = std::uintmax_t{64} << 20;

bool usable_name(const std::string& name) {
  const auto good = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; };
  return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), good);
}

std::optional<Error> too_little_space(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const auto space = std::filesystem::space(folder, error);
  if (error) return Error{ErrorCode::io, error.message(), folder.string(), "check the state directory"};
  if (space.available >= kLeastSpace) return std::nullopt;
  return Error{ErrorCode::io, "less than 64 MiB free", folder.string(), "remove old recordings"};
}

}  // namespace

struct Publisher::Handle {
  explicit Handle(const std::string& url) : lcm(lcm_create(url.c_str())) {}
  ~Handle() {
    if (lcm != nullptr) lcm_destroy(lcm);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  lcm_t* lcm;
};

Publisher::Publisher(const std::string& url, std::string prefix) : prefix_(std::move(prefix)) {
  if (!url.empty()) lcm_ = std::make_unique<Handle>(url);
}

Publisher::~Publisher() = default;

void Publisher::send(const std::string& channel, const std::string& message) {
  if (!lcm_) return;
  const std::string name = prefix_ + channel;
  const bool good = lcm_->lcm != nullptr && lcm_publish(lcm_->lcm, name.c_str(), message.data(),
                                                        static_cast<unsigned>(message.size())) == 0;
  ++(good ? sent_ : failed_);
}

Result<std::filesystem::path> Recorder::start(const std::string& name) {
  if (!usable_name(name))
    return Error{ErrorCode::usage, fmt::format("\"{}\" is no name for a recording", name), "",
                 "use letters, digits, - and _, at most 64"};
  if (auto problem = too_little_space(folder_)) return *problem;
  std::filesystem::path path = folder_ / (name + ".lcmlog");
  for (int i = 2; std::filesystem::exists(path) && i < 10000; ++i)
    path = folder_ / fmt::format("{}-{}.lcmlog", name, i);
  auto log = RecordingLog::create(path, prefix_);
  if (!log) return log.error();
  log_.emplace(std::move(log).value());
  problem_.reset();
  return path;
}

void Recorder::write(std::int64_t utime, const std::string& channel, const std::string& message) {
  if (!log_ || problem_) return;
  if (log_->bytes() + message.size() > kLargestRecording) {
    problem_ =
        Error{ErrorCode::io, "recording has reached 512 MiB", log_->path().string(), "record less at once"};
    return;
  }
  if (auto written = log_->write(utime, prefix_ + channel, message); !written) problem_ = written.error();
}

void Recorder::write_frame(std::int64_t utime, const drivers::CanFrame& frame) {
  if (!log_ || frame_bytes_ > kLargestRecording) return;
  if (!frames_.is_open()) {
    auto path = log_->path();
    frames_.open(path.replace_extension(".candump"), std::ios::trunc);
  }
  drivers::CanFrame stamped = frame;
  stamped.t = 1e-6 * static_cast<double>(utime);
  const std::string line = drivers::candump_line(stamped, "can0") + "\n";
  frame_bytes_ += line.size();
  frames_ << line;
}

Result<std::filesystem::path> Recorder::finish() {
  if (!log_) return Error{ErrorCode::usage, "nothing is being recorded", "", "start a recording first"};
  const std::filesystem::path path = log_->path();
  if (auto flushed = log_->flush(true); !flushed && !problem_) problem_ = flushed.error();
  log_.reset();
  frames_.close();
  frame_bytes_ = 0;
  if (problem_) return *problem_;
  return path;
}

}  // namespace odomcalib
