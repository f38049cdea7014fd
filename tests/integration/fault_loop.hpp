// A robot whose motion somebody disturbs, and what its drive and its clients see of it.
#pragma once

#include <limits>

#include "tests/integration/service_loop.hpp"

namespace odomcalib {

class FaultLoop : public ServiceLoop {
 protected:
  Calibrator calibrator() override { return make_calibrator(); }
  bool drive_turns() {
    const auto order = robot_->node().order();
    return order.torque && (order.rate[0] != 0.0 || order.rate[1] != 0.0);
  }
  /// s from now until the drive is no longer told to turn; NaN when that takes more than `seconds`.
  double time_to_zero(double seconds) {
    const double begin = clock_.time;
    return run_until([this] { return !drive_turns(); }, seconds) ? clock_.time - begin
                                                                 : std::numeric_limits<double>::quiet_NaN();
  }
  json end_of(TestClient& mover, double seconds) {
    std::optional<control::Reply> got;
    run_until([&] { return (got = mover.reply()).has_value(); }, seconds);
    if (!got) return {{"error", "no reply"}};
    return {{"error", got->error}, {"parameters", json::parse(got->parameters, nullptr, false)}};
  }
  static bool stopped(const json& end) {
    return end["error"] == "org.odomcalib.Calibration.ProtectiveStop" ||
           end["error"] == "org.odomcalib.Calibration.Device" ||
           end["error"] == "org.odomcalib.Calibration.DeviceUnavailable";
  }
  bool usable(const std::string& state) {
    if (++steps_ % 25 != 0) return false;
    const json now = status();
    return now["state"] == "idle" && now["controller"]["state"] == state &&
           now["controller"]["stale"] == "" && now["lidar"]["stale"] == "";
  }
  void expect_no_restart(double seconds) {
    run_until([this] { return robot_->fastest_rim() < 1e-3; }, 3.0);
    EXPECT_FALSE(run_until([this] { return robot_->fastest_rim() > 5e-3 || drive_turns(); }, seconds));
  }
};

}  // namespace odomcalib
