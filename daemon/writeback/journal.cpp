#include "daemon/writeback/journal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>
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

// Whether values may have been stored, by a record of an earlier version, which did not say it.
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
  return ::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0640);
}

bool is_end(JournalState state) {
  return state == JournalState::commit || state == JournalState::rolled_back ||
         state == JournalState::needs_operator;
}

constexpr std::size_t kCrcDigits = 8;

/// Whether a power cut may leave this of a record: its beginning, or zeros where a part of it did not reach
/// the disk, in the space that was reserved for it.
bool may_be_torn(std::string_view rest) {
  if (rest.size() > Journal::kReserved) return false;
  const auto fits = [](std::size_t at, char found) {
    if (found == '\0') return true;
    if (at < kCrcDigits) return std::isxdigit(static_cast<unsigned char>(found)) != 0;
    return found == (at == kCrcDigits ? ' ' : '{');
  };
  for (std::size_t at = 0; at < rest.size() && at < kCrcDigits + 2; ++at)
    if (!fits(at, rest[at])) return false;
  return true;
}

/// @param visit called with each good record. @param damage what else there is. @return how many bytes the
/// lines have
template <typename Visit>
std::size_t visit_lines(const std::string& bytes, Visit visit, JournalDamage& damage) {
  std::size_t good = 0, line = 1;
  for (std::size_t end = 0; (end = bytes.find('\n', good)) != std::string::npos; good = end + 1, ++line) {
    if (auto record = from_line(bytes.substr(good, end - good))) {
      visit(std::move(*record));
    } else {
      ++damage.lines;
      damage.last_line = line;
    }
  }
  const auto rest = std::string_view(bytes).substr(good);
  if (!may_be_torn(rest)) damage.bytes = rest.size();
  return good;
}

std::filesystem::path older_file(const std::filesystem::path& path) { return path.string() + ".1"; }

}  // namespace

std::string name_of(JournalState state) { return kNames.at(static_cast<std::size_t>(state)); }

std::string to_line(const JournalRecord& record) {
  json body = {{"seq", record.seq},
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
  write_provenance(record.origin, body);
  const std::string text = body.dump(-1, ' ', true, json::error_handler_t::replace);
  return crc_of(text) + " " + text + "\n";
}

std::optional<JournalRecord> from_line(const std::string& line) {
  constexpr std::size_t kBody = kCrcDigits + 1;
  if (line.size() < kBody || line[kCrcDigits] != ' ' ||
      crc_of(line.substr(kBody)) != line.substr(0, kCrcDigits))
    return std::nullopt;
  try {
    const json body = json::parse(line.substr(kBody));
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
                         .unproven = body.value("unproven", false),
                         .origin = read_provenance(body)};
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

std::string to_text(const JournalDamage& damage) {
  constexpr const char* kLookAt =
      "; what was written last may be missing: compare odomcalibctl history with odomcalibctl params get";
  if (damage.unreadable) return damage.unreadable->text() + kLookAt;
  std::string what;
  if (damage.lines == 1) what = fmt::format("line {} cannot be read", damage.last_line);
  if (damage.lines > 1)
    what = fmt::format("{} lines cannot be read, the last is line {}", damage.lines, damage.last_line);
  if (damage.bytes > 0)
    what += fmt::format("{}{} bytes behind the last line are no record", what.empty() ? "" : ", and ",
                        damage.bytes);
  return damage.file.string() + ": " + what + kLookAt;
}

Journal::~Journal() {
  if (fd_ >= 0) close(fd_);
}

Journal::Journal(Journal&& other) noexcept
    : path_(std::move(other.path_)),
      fd_(std::exchange(other.fd_, -1)),
      size_(other.size_),
      uncut_(other.uncut_),
      last_(std::move(other.last_)),
      ends_(std::move(other.ends_)),
      damage_(std::move(other.damage_)) {}

Result<Journal> Journal::open(const std::filesystem::path& path) {
  std::error_code ignored;
  std::filesystem::create_directories(path.parent_path(), ignored);
  const int fd = open_file(path);
  if (fd < 0) return failed(path);
  Journal journal(path, fd);
  // A file that was just made is lost with its records unless its folder is on the disk too.
  if (auto synced = sync_folder(path); !synced) return synced.error();
  const auto bytes = journal.read_lines();
  if (!bytes) return bytes.error();
  // Space that the records of an unfinished write-back need is left to them: they are written over it.
  const bool needless = !journal.unfinished() && journal.size_ < bytes.value();
  if (needless && ftruncate(fd, static_cast<off_t>(journal.size_)) != 0) return failed(path);
  return journal;
}

Result<Journal> Journal::open_read_only(const std::filesystem::path& path) {
  Journal journal(path, -1);
  if (const auto bytes = journal.read_lines(); !bytes) return bytes.error();
  return journal;
}

/// @return how many bytes there are
Result<std::size_t> Journal::read_lines() {
  const auto note = [this](JournalRecord record) {
    if (is_end(record.state)) ends_.push_back(record);
    last_ = std::move(record);
  };
  const auto visit = [&](const std::filesystem::path& file, const std::string& bytes) {
    JournalDamage damage{.file = file};
    const std::size_t size = visit_lines(bytes, note, damage);
    if (damage.lines > 0 || damage.bytes > 0) damage_.push_back(std::move(damage));
    return size;
  };
  const auto older = older_file(path_);
  if (const auto bytes = read_file_bytes(older))
    visit(older, bytes.value());
  else if (!is_absent(older))
    damage_.push_back({.file = older, .unreadable = bytes.error()});
  // A crash within a rotation leaves the file before it alone.
  if (is_absent(path_)) return std::size_t{0};
  const auto bytes = read_file_bytes(path_);
  if (!bytes) return bytes.error();
  size_ = visit(path_, bytes.value());
  return bytes.value().size();
}

// A new file whose folder is not on the disk would be lost with the write-back that it announces.
Result<void> Journal::rotate() {
  const std::filesystem::path full = older_file(path_);
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
  return ::pwrite(fd_, line.data(), line.size(), static_cast<off_t>(size_)) ==
             static_cast<ssize_t>(line.size()) &&
         fdatasync(fd_) == 0;
}

/// Takes the space from the disk before anything is done that a record would have to follow.
Result<void> Journal::reserve() {
  errno = posix_fallocate(fd_, static_cast<off_t>(size_), static_cast<off_t>(kReserved));
  return errno == 0 ? Result<void>() : failed(path_);
}

/// After a failure the disk may be too full or too broken for this, too.
void Journal::cut() { uncut_ = ftruncate(fd_, static_cast<off_t>(size_)) != 0; }

Result<void> Journal::append(JournalRecord record) {
  if (fd_ < 0)
    return Error{ErrorCode::io, "nothing can be written to the journal", path_.string(),
                 "check the state directory, then restart the daemon"};
  // Only between write-backs: the records of one stay together, and one that is unfinished is not put away.
  const bool begins = record.state == JournalState::begin;
  if (begins && !unfinished() && size_ >= kRotateAt)
    if (auto rotated = rotate(); !rotated) return rotated;
  record.seq = last_ ? last_->seq + 1 : 1;
  const std::string line = to_line(record);
  if (uncut_) cut();
  if (uncut_) return failed(path_);
  auto written = begins ? reserve() : Result<void>();
  if (written && !write_whole(line)) written = failed(path_);
  if (!written) {
    cut();
    if (unfinished()) (void)reserve();
    return written;
  }
  size_ += line.size();
  last_ = std::move(record);
  if (!unfinished()) cut();
  return {};
}

std::optional<JournalRecord> unfinished_of(const std::optional<JournalRecord>& last) {
  if (!last) return std::nullopt;
  const bool ended = last->state == JournalState::commit || last->state == JournalState::rolled_back;
  return ended ? std::nullopt : last;
}

}  // namespace odomcalib
