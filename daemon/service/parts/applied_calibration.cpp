#include "daemon/service/parts/applied_calibration.hpp"

namespace odomcalib {

std::optional<Error> AppliedCalibration::load() {
  calibration_.reset();
  odometry_.reset();
  if (!std::filesystem::exists(file.path())) return std::nullopt;
  auto read = read_calibration(file.path());
  if (!read) return read.error();
  calibration_ = std::move(read).value();
  if (calibrator_.odometry) odometry_ = calibrator_.odometry(*calibration_);
  return std::nullopt;
}

std::optional<PoseSample> AppliedCalibration::corrected(const TickSample& sample) {
  return odometry_ ? std::optional((*odometry_)(sample)) : std::nullopt;
}

std::optional<std::string> AppliedCalibration::text() const {
  return calibration_ ? std::optional(to_json(*calibration_)) : std::nullopt;
}

}  // namespace odomcalib
