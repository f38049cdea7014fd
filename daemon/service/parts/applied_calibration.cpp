#include "daemon/service/parts/applied_calibration.hpp"

namespace odomcalib {

Result<std::optional<Calibration>> AppliedCalibration::read() const {
  if (!std::filesystem::exists(file.path())) return std::optional<Calibration>();
  auto read = read_calibration(file.path());
  if (!read) return read.error();
  return std::optional(std::move(read).value());
}

void AppliedCalibration::take(const Result<std::optional<Calibration>>& read) {
  calibration_ = read ? read.value() : std::nullopt;
  odometry_.reset();
  if (calibration_ && calibrator_.odometry) odometry_ = calibrator_.odometry(*calibration_);
}

std::optional<PoseSample> AppliedCalibration::corrected(const TickSample& sample) {
  return odometry_ ? std::optional((*odometry_)(sample)) : std::nullopt;
}

std::optional<std::string> AppliedCalibration::text() const {
  return calibration_ ? std::optional(to_json(*calibration_)) : std::nullopt;
}

}  // namespace odomcalib
