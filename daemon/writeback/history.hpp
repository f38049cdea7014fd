// What was written to the controller, when, and what was in force before: one file an entry, and the
// calibration in force.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

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
};

std::string to_json(const HistoryEntry& entry, bool with_calibration);

class History {
 public:
  static constexpr std::size_t kKept = 50;

  /// @param folder of the state directory; made on the first entry
  explicit History(std::filesystem::path folder) : folder_(std::move(folder)) {}
  /// Oldest entries beyond kKept are removed. Error: io.
  Result<std::string> add(HistoryEntry entry);
  /// Newest first; entries that cannot be read are left out.
  [[nodiscard]] std::vector<HistoryEntry> entries() const;
  [[nodiscard]] std::optional<HistoryEntry> find(const std::string& id) const;
  [[nodiscard]] std::optional<HistoryEntry> newest_committed() const;

 private:
  [[nodiscard]] std::vector<std::filesystem::path> files() const;
  std::filesystem::path folder_;
};

}  // namespace odomcalib
