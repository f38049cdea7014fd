// The journal as the loop sees it: a record is handed over, and later it is on the disk or it is not.
#pragma once

#include <memory>
#include <optional>

#include "daemon/writeback/background.hpp"
#include "daemon/writeback/journal.hpp"

namespace odomcalib {

class JournalWriter {
 public:
  /// @param journal, background outlive this; nobody else writes to the journal
  JournalWriter(Journal& journal, Background& background);

  /// Begins to write; one record at a time. seq is given by the journal.
  void append(JournalRecord record);
  /// A record is on its way.
  [[nodiscard]] bool pending() const { return pending_; }
  /// Result of the newest append(), once: on the disk, or the error (io) for which it is not.
  [[nodiscard]] std::optional<Result<void>> take_result();

  /// The newest record on the disk, if any.
  [[nodiscard]] const std::optional<JournalRecord>& last() const {
    return pending_ ? before_ : journal_.last();
  }
  /// The newest record on the disk, when its write-back was not brought to an end.
  [[nodiscard]] std::optional<JournalRecord> unfinished() const { return unfinished_of(last()); }

 private:
  Journal& journal_;
  Background& background_;
  std::optional<JournalRecord> before_;  // the newest one while another is on its way
  bool pending_ = false;
  std::optional<Result<void>> result_;
};

}  // namespace odomcalib
