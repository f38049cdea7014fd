#include "daemon/service/telemetry.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>

#include "daemon/service/settings.hpp"
#include "drivers/can/candump.hpp"

namespace odomcalib {
namespace {

bool usable_name(const std::string& name) {
  const auto good = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; };
  return !name.empty() && name.size() <= service::settings::kLongestName &&
         std::all_of(name.begin(), name.end(), good);
}

std::optional<Error> too_little_space(const std::filesystem::path& folder) {
  constexpr std::uintmax_t kMegabyte = 1'000'000;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const auto space = std::filesystem::space(folder, error);
  if (error) return Error{ErrorCode::io, error.message(), folder.string(), "check the state directory"};
  if (access(folder.c_str(), W_OK) != 0)
    return Error{ErrorCode::io, std::strerror(errno), folder.string(), "check the state directory"};
  if (space.available / kMegabyte >= service::settings::kLeastSpace_MB) return std::nullopt;
  return Error{ErrorCode::io, "less than 64 MB free", folder.string(), "remove old recordings"};
}

}  // namespace

Recorder::Recorder(std::filesystem::path folder, std::string prefix, MakeSink make_sink)
    : folder_(std::move(folder)), prefix_(std::move(prefix)), make_sink_(std::move(make_sink)) {}

// One that ended may not have its file yet.
std::filesystem::path Recorder::free_path(const std::string& name) const {
  const auto taken = [this](const std::filesystem::path& path) {
    return std::filesystem::exists(path) ||
           std::any_of(ending_.begin(), ending_.end(), [&](const Job& job) { return job.path == path; });
  };
  std::filesystem::path path = folder_ / (name + ".lcmlog");
  for (int i = 2; taken(path) && i < 10000; ++i) path = folder_ / fmt::format("{}-{}.lcmlog", name, i);
  return path;
}

Result<std::filesystem::path> Recorder::start(const std::string& name) {
  if (!usable_name(name))
    return Error{ErrorCode::usage, fmt::format("\"{}\" is no name for a recording", name), "",
                 "use letters, digits, - and _, at most 64"};
  if (ending_.size() >= kMostUnfinished)
    return Error{ErrorCode::io, "older recordings are still being written", folder_.string(),
                 "wait; check the disk"};
  if (auto problem = too_little_space(folder_)) return *problem;
  Job job;
  job.path = free_path(name);
  job.writer = std::make_unique<RecordingWriter>(make_sink_(job.path, prefix_));
  current_.emplace(std::move(job));
  return current_->path;
}

void Recorder::push(RecordedItem item) {
  const auto refuse = [this](const char* what, const char* remedy) {
    current_->problem = Error{ErrorCode::io, what, current_->path.string(), remedy};
  };
  if (current_->problem) return;
  current_->bytes += item.bytes.size();
  if (current_->bytes > service::settings::kLargestRecording_bytes)
    return refuse("recording has reached 512 MiB", "record less at once");
  if (!current_->writer->push(std::move(item)))
    refuse("the disk does not keep up with the recording", "check the disk; record to a faster one");
}

void Recorder::write(std::int64_t utime, const std::string& channel, const std::string& message) {
  if (current_) push({utime, prefix_ + channel, message});
}

void Recorder::write_frame(std::int64_t utime, const drivers::CanFrame& frame) {
  if (!current_ || current_->frame_bytes > service::settings::kMostFrames_bytes) return;
  drivers::CanFrame stamped = frame;
  stamped.t = 1e-6 * static_cast<double>(utime);
  std::string line = drivers::candump_line(stamped, "can0") + "\n";
  current_->frame_bytes += line.size();
  push({utime, "", std::move(line)});
}

void Recorder::finish(Done done) {
  if (!current_) return;
  current_->writer->end();
  current_->done = std::move(done);
  ending_.push_back(std::move(*current_));
  current_.reset();
}

void Recorder::serve() {
  for (std::size_t i = 0; i < ending_.size();) {
    if (!ending_[i].writer->finished()) {
      ++i;
      continue;
    }
    const Job job = std::move(ending_[i]);
    ending_.erase(ending_.begin() + static_cast<std::ptrdiff_t>(i));
    const auto problem = job.first_problem();
    if (job.done) job.done(problem ? Result<std::filesystem::path>(*problem) : job.path);
  }
}

std::optional<Error> Recorder::problem() const { return current_ ? current_->first_problem() : std::nullopt; }

}  // namespace odomcalib
