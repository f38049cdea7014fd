// The calibration in force, and the corrected odometry that the host makes with it.
#pragma once

#include <optional>

#include "daemon/service/calibrator.hpp"
#include "daemon/writeback/calibration_in_force.hpp"

namespace odomcalib {

class AppliedCalibration {
 public:
  /// @param functions outlives this
  AppliedCalibration(const std::filesystem::path& state_dir, const Calibrator& functions)
      : file(state_dir), calibrator_(functions) {}

  /// Reads what is in force now. Changes nothing: may run beside the loop. nullopt: none is.
  [[nodiscard]] Result<std::optional<Calibration>> read() const;
  /// Goes on with what was read; with none where that failed.
  void take(const Result<std::optional<Calibration>>& read);
  [[nodiscard]] const std::optional<Calibration>& get() const { return calibration_; }
  /// Where the corrected odometry is after this sample; nullopt: there is none.
  std::optional<PoseSample> corrected(const TickSample& sample);
  [[nodiscard]] std::optional<std::string> text() const;  ///< JSON

  CalibrationInForce file;

 private:
  const Calibrator& calibrator_;
  std::optional<Calibration> calibration_;
  std::optional<Calibrator::Odometry> odometry_;
};

}  // namespace odomcalib
