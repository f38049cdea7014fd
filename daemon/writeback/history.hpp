// Values written to the controller, when, and those in force before: one file an entry. The entries are
// read once: a client that requests them does not wait for a disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "daemon/writeback/journal.hpp"
#include "daemon/writeback/provenance.hpp"
#include "daemon/writeback/settings.hpp"
#include "proto/result.hpp"

namespace odomcalib {

struct HistoryEntry {
  std::string id;                          ///< "0001" and so on, given by add()
  std::int64_t time = 0;                   ///< us since 1970
  std::string action;                      ///< apply, rollback
  std::string outcome;                     ///< committed, rolled_back, unknown
  std::optional<std::string> calibration;  ///< JSON text of the calibration applied
  std::map<std::string, double> before, after;
  std::string device;  ///< the controller, see device_of(); empty: not known
  Provenance origin = {};
};

/// Entry from the record with which a write-back ended, but for the calibration's text.
HistoryEntry entry_of(const JournalRecord& end);

std::string to_json(const HistoryEntry& entry, bool with_calibration);

/// Entry of a history from what to_json() made of it; nullopt: it is none.
std::optional<HistoryEntry> history_entry_from(const nlohmann::ordered_json& body);

class History {
 public:
  static constexpr std::size_t kKept = writeback::settings::kKeptEntries;

  /// Reads what is there; entries that cannot be read are left out, see unreadable() and unlisted().
  /// @param folder of the state directory; made on the first entry
  explicit History(std::filesystem::path folder);

  /// The entry with the id that it gets.
  [[nodiscard]] HistoryEntry numbered(HistoryEntry entry) const;
  /// Puts a numbered entry on the disk and removes the oldest ones beyond kKept there. Changes nothing else:
  /// may run beside the loop. Error: io, also where entries may be there that it would write over.
  [[nodiscard]] Result<void> write(const HistoryEntry& entry) const;
  /// Takes over a numbered entry, in the place of one with the same id.
  void keep(HistoryEntry entry);
  /// Whether there is an entry of this id that tells of the same end.
  [[nodiscard]] bool knows(const HistoryEntry& entry) const;
  /// Takes over what a later look at the same folder has found. Entries of its own that are not among it
  /// stay.
  void take_over(History found);
  /// Those ends of the journal without an entry, or with another one, as far back as entries are kept.
  [[nodiscard]] std::vector<JournalRecord> missing(const std::vector<JournalRecord>& ends) const;

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// Newest first.
  [[nodiscard]] const std::vector<HistoryEntry>& entries() const { return entries_; }
  /// Files that are there and hold no entry that can be read, newest first.
  [[nodiscard]] const std::vector<std::filesystem::path>& unreadable() const { return unreadable_; }
  /// Why nobody knows which entries are there; nullopt: it is known.
  [[nodiscard]] const std::optional<Error>& unlisted() const { return unlisted_; }
  [[nodiscard]] std::optional<HistoryEntry> find(const std::string& id) const;
  [[nodiscard]] std::optional<HistoryEntry> newest_committed() const;

 private:
  struct Listing {
    std::vector<std::filesystem::path> files;  ///< newest first
    std::optional<Error> error;                ///< of a folder that is there; `files` may be a part of it
  };
  [[nodiscard]] Listing listing() const;

  std::filesystem::path folder_;
  std::vector<HistoryEntry> entries_;
  std::vector<std::filesystem::path> unreadable_;
  std::optional<Error> unlisted_;
  unsigned newest_ = 0;  // number, also of an entry that cannot be read
};

}  // namespace odomcalib
