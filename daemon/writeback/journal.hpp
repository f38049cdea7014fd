// Steps of a write-back, on the disk before it takes them: append-only lines, each with its CRC.
// Until one has ended, zeros behind the last line hold the space for the records that may follow.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "daemon/writeback/provenance.hpp"
#include "daemon/writeback/settings.hpp"
#include "proto/result.hpp"

namespace odomcalib {

/// The steps of a write-back in their order (docs/evidence/faults.md). A record announces the action behind
/// it.
enum class JournalState {
  begin,           ///< old values are known, nothing is changed
  write,           ///< new values go to the controller's RAM
  readback_ok,     ///< RAM holds the new values
  proof_ok,        ///< a motion with the new values has proven them
  store_begin,     ///< RAM goes to permanent memory
  store_ok,        ///< stored and read again
  commit,          ///< done: new values in force
  rollback,        ///< old values go back
  rolled_back,     ///< done: old values in force
  needs_operator,  ///< neither could be reached
};

std::string name_of(JournalState state);

struct JournalRecord {
  std::uint64_t seq = 0;
  double monotonic = 0.0;    ///< s
  std::int64_t wall_us = 0;  ///< us since 1970
  JournalState state = JournalState::begin;
  std::string label;                     ///< what asked for it: "apply", "rollback"
  std::map<std::string, double> before;  ///< SI, by quantity
  std::map<std::string, double> after;
  std::string device;  ///< who holds these values; empty: it does not say, or an earlier version wrote this
  std::string calibration;   ///< id of the one in force with `after`, see CalibrationInForce
  bool store_begun = false;  ///< permanent memory may hold other values than `before`
  bool unproven = false;     ///< `after` is to be proven by a motion first: until then `before` comes back
  Provenance origin = {};
};

/// One line: CRC-32 (zlib's) as hex, a space, a JSON object, a newline.
std::string to_line(const JournalRecord& record);
/// nullopt: torn or damaged.
std::optional<JournalRecord> from_line(const std::string& line);

/// Content of one file of the journal that is no record.
struct JournalDamage {
  std::filesystem::path file;
  std::size_t lines = 0;      ///< that hold no record
  std::size_t last_line = 0;  ///< number of the last of them, from 1
  std::size_t bytes = 0;  ///< behind the last line, where they are more than a power cut leaves of a record
  std::optional<Error> unreadable = {};  ///< the whole file, which is there
};

/// Says what of the journal is passed over, and what to look at.
std::string to_text(const JournalDamage& damage);

/// The record when its write-back was not brought to an end.
std::optional<JournalRecord> unfinished_of(const std::optional<JournalRecord>& last);

class Journal {
 public:
  static constexpr std::uintmax_t kRotateAt = writeback::settings::kRotateAt_bytes;
  static constexpr std::uintmax_t kReserved = writeback::settings::kReserved_bytes;

  /// Reads what is there; a torn last line is dropped, space that is reserved is kept. Errors: io.
  static Result<Journal> open(const std::filesystem::path& path);
  /// Reads what is there, in this file or the one before it; append() is an error. Errors: io, it is there
  /// and cannot be read.
  static Result<Journal> open_read_only(const std::filesystem::path& path);
  ~Journal();
  Journal(Journal&& other) noexcept;
  Journal& operator=(Journal&&) = delete;

  /// On the disk when it returns. seq is given by the journal. Error: io; then the action must not be taken.
  /// A record that could not be written whole leaves no trace: the next one is not spoiled by it. A record
  /// `begin` is written when there is space for all that may follow it, too.
  Result<void> append(JournalRecord record);
  /// The newest record, if any.
  [[nodiscard]] const std::optional<JournalRecord>& last() const { return last_; }
  /// The newest record when its write-back was not brought to an end.
  [[nodiscard]] std::optional<JournalRecord> unfinished() const { return unfinished_of(last_); }
  /// How the write-backs ended that were there when it was opened, in this file and the one before it, oldest
  /// first: what the history is made of where an entry is missing.
  [[nodiscard]] const std::vector<JournalRecord>& ends() const { return ends_; }
  /// Damage that was passed over when it was opened, in this file and the one before it; a file without
  /// damage has no entry.
  [[nodiscard]] const std::vector<JournalDamage>& damage() const { return damage_; }

 private:
  Journal(std::filesystem::path path, int fd) : path_(std::move(path)), fd_(fd) {}
  [[nodiscard]] Result<std::size_t> read_lines();
  [[nodiscard]] bool write_whole(const std::string& line) const;
  [[nodiscard]] Result<void> reserve();
  void cut();
  Result<void> rotate();

  std::filesystem::path path_;
  int fd_ = -1;
  std::uintmax_t size_ = 0;  // bytes, of whole records
  bool uncut_ = false;       // a record that failed may still be behind them
  std::optional<JournalRecord> last_;
  std::vector<JournalRecord> ends_;
  std::vector<JournalDamage> damage_;
};

}  // namespace odomcalib
