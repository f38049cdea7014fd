// The calibration whose values the controller holds and whose remainder the host applies. It changes with the
// commit of a write-back, wherever a crash interrupts the two.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "proto/calibration/calibration.hpp"
#include "proto/result.hpp"

namespace odomcalib {

/// JSON text of a calibration as it is applied: without the points of the report's figures, because it is
/// journaled and read again and again.
std::string text_in_force(Calibration calibration);

/// A write-back first announces the calibration that comes with it, and journals the id that it gets. Once it
/// has committed that id is settled: at once, by the recovery that commits it, or at the next start.
class CalibrationInForce {
 public:
  /// @param folder of the state directory
  explicit CalibrationInForce(const std::filesystem::path& folder)
      : path_(folder / "active.json"), announced_(folder / "announced") {}

  /// @param calibration JSON text; nullopt: after the write-back none is in force
  /// @param journaled id of the newest record, whose calibration may still be needed; others are forgotten
  /// @return id. Error: io; then the write-back must not begin
  [[nodiscard]] Result<std::string> announce(const std::optional<std::string>& calibration,
                                             const std::string& journaled) const;
  /// JSON text of an announced calibration; nullopt: none has this id.
  [[nodiscard]] std::optional<std::string> announced(const std::string& id) const;
  /// Puts in force what was announced under this id; an empty one, of a write-back without a calibration,
  /// changes nothing. May be repeated. Error: io.
  [[nodiscard]] Result<void> settle(const std::string& id) const;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  [[nodiscard]] std::filesystem::path file_of(const std::string& id) const;
  void forget_all_but(const std::string& journaled) const;
  [[nodiscard]] Result<void> put_out_of_force() const;

  std::filesystem::path path_, announced_;
};

}  // namespace odomcalib
