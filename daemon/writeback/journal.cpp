#include "daemon/writeback/journal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

#include "proto/file_bytes.hpp"

namespace odomcalib {
namespace {

using nlohmann::json;

constexpr std::array kNames = {"begin",    "write",  "readback_ok", "proof_ok",    "store_begin",
                               "store_ok", "commit", "rollback",    "rolled_back", "needs_operator"};

std::optional<JournalState> state_named(const std::string& name) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (name == kNames.at(i)) return static_cast<JournalState>(i);
  return std::nullopt;
}

// What a record of an earlier version, which did not say it, leaves possible.
bool may_have_stored(JournalState state) {
  return state != JournalState::begin && state != JournalState::write && state != JournalState::readback_ok;
}

std::string crc_of(const std::string& text) {
  const auto crc = crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size()));
  return fmt::format("{:08x}", crc);
}

Error failed(const std::filesystem::path& path) {
  return {ErrorCode::io, std::strerror(errno), path.string(), "check the state directory and its free space"};
}

int open_file(const std::filesystem::path& path) {
  return ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0640);
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
  const json body = {{"seq", record.seq},
                     {"monotonic", record.monotonic},
                     {"wall_us", record.wall_us},
                     {"state", name_of(record.state)},
                     {"label", record.label},
                     {"before", record.before},
                     {"after", record.after},
                     {"device", record.device},
                     {"calibration", record.calibration},
                     {"store_begun", record.store_begun},
                     {"unproven", record.unproven}};
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
    const bool whole = body.at("seq").is_number_unsigned() && body.at("wall_us").is_number_integer();
    if (!state || !whole) return std::nullopt;
    return JournalRecord{.seq = body.at("seq").get<std::uint64_t>(),
                         .monotonic = body.at("monotonic").get<double>(),
                         .wall_us = body.at("wall_us").get<std::int64_t>(),
                         .state = *state,
                         .label = body.at("label").get<std::string>(),
                         .before = body.at("before").get<std::map<std::string, double>>(),
                         .after = body.at("after").get<std::map<std::string, double>>(),
                         .device = body.value("device", ""),
                         .calibration = body.value("calibration", ""),
                         .store_begun = body.value("store_begun", may_have_stored(*state)),
                         .unproven = body.value("unproven", false)};
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

Journal::~Journal() {
  if (fd_ >= 0) close(fd_);
}

Journal::Journal(Journal&& other) noexcept
    : path_(std::move(other.path_)),
      fd_(std::exchange(other.fd_, -1)),
      size_(other.size_),
      last_(std::move(other.last_)) {}

Result<Journal> Journal::open(const std::filesystem::path& path) {
  std::error_code ignored;
  std::filesystem::create_directories(path.parent_path(), ignored);
  const int fd = open_file(path);
  if (fd < 0) return failed(path);
  Journal journal(path, fd);
  // A file that was just made is lost with its records unless its folder is on the disk too.
  if (auto synced = sync_folder(path); !synced) return synced.error();
  const auto bytes = read_file_bytes(path);
  if (!bytes) return bytes.error();
  const auto [last, good] = last_good(bytes.value());
  journal.last_ = last;
  journal.size_ = good;
  // A torn end would swallow the next record.
  if (good < bytes.value().size() && ftruncate(fd, static_cast<off_t>(good)) != 0) return failed(path);
  return journal;
}

Result<Journal> Journal::open_read_only(const std::filesystem::path& path) {
  Journal journal(path, -1);
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return journal;
  const auto bytes = read_file_bytes(path);
  if (!bytes) return bytes.error();
  journal.last_ = last_good(bytes.value()).first;
  return journal;
}

// A new file whose folder is not on the disk would be lost with the write-back that it announces.
Result<void> Journal::rotate() {
  const std::filesystem::path full = path_.string() + ".1";
  if (::rename(path_.c_str(), full.c_str()) != 0) return failed(path_);
  const int fd = open_file(path_);
  auto begun = fd < 0 ? Result<void>(failed(path_)) : sync_folder(path_);
  if (!begun) (void)::rename(full.c_str(), path_.c_str());
  const int unused = begun ? std::exchange(fd_, fd) : fd;
  if (unused >= 0) close(unused);
  if (begun) size_ = 0;
  return begun;
}

bool Journal::write_whole(const std::string& line) const {
  return ::write(fd_, line.data(), line.size()) == static_cast<ssize_t>(line.size()) && fdatasync(fd_) == 0;
}

Result<void> Journal::append(JournalRecord record) {
  if (fd_ < 0)
    return Error{ErrorCode::io, "nothing can be written to the journal", path_.string(),
                 "check the state directory, then restart the daemon"};
  // Only between write-backs: the records of one stay together, and one that is unfinished is not put away.
  const bool may_rotate = record.state == JournalState::begin && !unfinished();
  if (may_rotate && size_ >= kRotateAt)
    if (auto rotated = rotate(); !rotated) return rotated;
  record.seq = last_ ? last_->seq + 1 : 1;
  const std::string line = to_line(record);
  const auto end = static_cast<off_t>(size_);
  // Once more before writing: after a failure the disk may have been too full or too broken to cut the end.
  if (ftruncate(fd_, end) != 0) return failed(path_);
  if (!write_whole(line)) {
    const Error error = failed(path_);
    (void)!ftruncate(fd_, end);
    return error;
  }
  size_ += line.size();
  last_ = std::move(record);
  return {};
}

std::optional<JournalRecord> unfinished_of(const std::optional<JournalRecord>& last) {
  if (!last) return std::nullopt;
  const bool ended = last->state == JournalState::commit || last->state == JournalState::rolled_back;
  return ended ? std::nullopt : last;
}

}  // namespace odomcalib
