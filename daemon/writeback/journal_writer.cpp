#include "daemon/writeback/journal_writer.hpp"

#include <utility>

namespace odomcalib {

Background& foreground() {
  static Foreground one;
  return one;
}

JournalWriter::JournalWriter(Journal& journal, Background& background)
    : journal_(journal), background_(background) {}

void JournalWriter::append(JournalRecord record) {
  before_ = journal_.last();
  pending_ = true;
  result_.reset();
  // An unfinished write is not on the disk.
  const auto written =
      std::make_shared<Result<void>>(Error{ErrorCode::io, "the record was not written", "journal", ""});
  background_.post(
      [&journal = journal_, record = std::move(record), written] { *written = journal.append(record); },
      [this, written] {
        pending_ = false;
        result_ = *written;
      });
}

std::optional<Result<void>> JournalWriter::take_result() { return std::exchange(result_, std::nullopt); }

}  // namespace odomcalib
