#include "calib/odometry/drive_clock.hpp"

#include <algorithm>

#include "calib/odometry/settings.hpp"

namespace odomcalib::calib::odometry {

DriveClock::DriveClock(const Calibration& calibration, double stamp) {
  if (calibration.data.empty()) return;
  const DataUse& drive = calibration.data.front();
  duration_ = drive.duration;
  // Several drives share no zero of time.
  if (calibration.data.size() > 1 || !drive.begin) return;
  const double since = stamp - *drive.begin;
  if (since >= -settings::kTogether_s && since <= settings::kAfterTheDrive * duration_) begin_ = drive.begin;
}

double DriveClock::at(double stamp) const {
  return begin_ ? std::clamp(stamp - *begin_, 0.0, duration_) : duration_ / 2.0;
}

}  // namespace odomcalib::calib::odometry
