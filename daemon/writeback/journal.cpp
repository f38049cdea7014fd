#include "daemon/writeback/journal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "proto/file_bytes.hpp"

namespace odomcalib {
namespace {

using nlohmann::json;

constexpr std::array kNames = {"begin",  "write",    "readback_ok", "store_begin",   "store_ok",
                               "commit", "rollback", "rolled_back", "needs_operator"};

std::optional<JournalState> state_named(const std::string& name) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (name == kNames.at(i)) return static_cast<JournalState>(i);
  return std::nullopt;
}

std::string crc_of(const std::string& text) {
  const auto crc = crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size()));
  return fmt::format("{:08x}", crc);
}

Error failed(const std::filesystem::path& path) {
  return {ErrorCode::io, std::strerror(errno), path.string(), "check the state directory and its free space"};
}

// The last good record, and how many bytes the good lines have.
std::pair<std::optional<JournalRecord>, std::size_t> last_good(const std::string& bytes) {
  std::optional<JournalRecord> last;
  std::size_t good = 0;
  for (std::size_t begin = 0; begin < bytes.size();) {
    const std::size_t end = bytes.find('\n', begin);
    if (end == std::string::npos) break;
    if (auto record = from_line(bytes.substr(begin, end - begin))) last = std::move(record);
    begin = end + 1;
    good = begin;
  }
  return {last, good};
}

}  // namespace

std::string name_of(JournalState state) { return kNames.at(static_cast<std::size_t>(state)); }

std::string to_line(const JournalRecord& record) {
  const json body = {{"seq", record.seq},         {"monotonic", record.monotonic},
                     {"wall_us", record.wall_us}, {"state", name_of(record.state)},
                     {"label", record.label},     {"before", record.before},
                     {"after", record.after}};
  const std::string text = body.dump(-1, ' ', true, json::error_handler_t::replace);
  return crc_of(text) + " " + text + "\n";
}

std::optional<JournalRecord> from_line(const std::string& line) {
  constexpr std::size_t kCrc = 8;
  if (line.size() <= kCrc || line[kCrc] != ' ' || crc_of(line.substr(kCrc + 1)) != line.substr(0, kCrc))
    return std::nullopt;
  try {
    const json body = json::parse(line.substr(kCrc + 1));
    const auto state = state_named(body.at("state").get<std::string>());
    if (!state) return std::nullopt;
    return JournalRecord{.seq = body.at("seq").get<std::uint64_t>(),
                         .monotonic = body.at("monotonic").get<double>(),
                         .wall_us = body.at("wall_us").get<std::int64_t>(),
                         .state = *state,
                         .label = body.at("label").get<std::string>(),
                         .before = body.at("before").get<std::map<std::string, double>>(),
                         .after = body.at("after").get<std::map<std::string, double>>()};
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

Journal::~Journal() {
  if (fd_ >= 0) close(fd_);
}

Journal::Journal(Journal&& other) noexcept
    : path_(std::move(other.path_)), fd_(std::exchange(other.fd_, -1)), last_(std::move(other.last_)) {}

Result<Journal> Journal::open(const std::filesystem::path& path) {
  std::error_code ignored;
  std::filesystem::create_directories(path.parent_path(), ignored);
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0640);
  if (fd < 0) return failed(path);
  Journal journal(path, fd);
  const auto bytes = read_file_bytes(path);
  if (!bytes) return bytes.error();
  const auto [last, good] = last_good(bytes.value());
  journal.last_ = last;
  // A torn end would swallow the next record.
  if (good < bytes.value().size() && ftruncate(fd, static_cast<off_t>(good)) != 0) return failed(path);
  return journal;
}

void Journal::rotate_when_large() {
  std::error_code error;
  if (std::filesystem::file_size(path_, error) < kRotateAt || error) return;
  // Only between write-backs: the records of one stay together.
  std::filesystem::rename(path_, path_.string() + ".1", error);
  const int fd = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0640);
  if (error || fd < 0) return;
  close(fd_);
  fd_ = fd;
}

Result<void> Journal::append(JournalRecord record) {
  if (record.state == JournalState::begin) rotate_when_large();
  record.seq = last_ ? last_->seq + 1 : 1;
  const std::string line = to_line(record);
  if (::write(fd_, line.data(), line.size()) != static_cast<ssize_t>(line.size()) || fdatasync(fd_) != 0)
    return failed(path_);
  last_ = std::move(record);
  return {};
}

std::optional<JournalRecord> Journal::unfinished() const {
  if (!last_) return std::nullopt;
  const bool ended = last_->state == JournalState::commit || last_->state == JournalState::rolled_back;
  return ended ? std::nullopt : last_;
}

}  // namespace odomcalib
