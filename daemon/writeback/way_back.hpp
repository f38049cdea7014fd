// The way back through what was written to one controller, entry by entry.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "daemon/writeback/history.hpp"
#include "drivers/base/controller.hpp"

namespace odomcalib {

class WayBack {
 public:
  using Values = std::map<std::string, double>;  ///< SI, by quantity

  /// @param entries newest first; outlive this
  /// @param device whose entries count, beside those of nobody; empty: all
  WayBack(const std::vector<HistoryEntry>& entries, const std::string& device);

  /// The entry before which a rollback goes that names none: one further back than the last one went. Null:
  /// there is nothing further back.
  [[nodiscard]] const HistoryEntry* next() const;
  /// The newest; null: nothing was committed.
  [[nodiscard]] const HistoryEntry* newest() const { return own_.empty() ? nullptr : own_.front(); }
  /// The committed one that came after this one; null: none.
  [[nodiscard]] const HistoryEntry* following(const HistoryEntry& entry) const;
  /// All that is known to have been in force before and after this entry.
  [[nodiscard]] Values before(const HistoryEntry& entry) const;
  [[nodiscard]] Values after(const HistoryEntry& entry) const;
  /// The newest entry with which these values were committed, each within half a step; null: they never were.
  [[nodiscard]] const HistoryEntry* verified(const Values& values,
                                             const std::vector<drivers::StoredParameter>& steps) const;
  /// The newest committed entry that is older than the one of this id; null: none is.
  [[nodiscard]] const HistoryEntry* older_than(const std::string& id) const;

 private:
  std::vector<const HistoryEntry*> own_;  // committed, newest first
};

}  // namespace odomcalib
