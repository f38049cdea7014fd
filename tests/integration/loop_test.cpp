// The whole loop in virtual time: drive, solve, write back, power cycle, drive again: the error went down.
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "tests/integration/service_loop.hpp"

namespace odomcalib {
namespace {

constexpr std::array kNames{"left_wheel_diameter", "right_wheel_diameter", "track_width"};

class WholeLoop : public ServiceLoop {
 protected:
  // The solver has a thread and real time of its own: virtual time goes slowly meanwhile.
  Calibrator calibrator() override {
    Calibrator functions = make_calibrator();
    functions.solve = [this, solve = functions.solve](const auto& recordings, const auto& effects,
                                                      const auto& progress) {
      solving_ = true;
      auto result = solve(recordings, effects, progress);
      solving_ = false;
      return result;
    };
    return functions;
  }
  json call(const std::string& method, json parameters) {
    TestClient caller(folder_ / "control");
    parameters["lease"] = lease_;
    caller.call(method, parameters, true);
    std::optional<control::Reply> reply;
    run_until(
        [&] {
          if (solving_) std::this_thread::sleep_for(std::chrono::milliseconds(2));
          return (reply = caller.reply()).has_value();
        },
        2000.0);
    EXPECT_TRUE(reply && reply->error.empty()) << method << ": " << (reply ? reply->parameters : "no reply");
    return reply ? json::parse(reply->parameters).value("result", json::object()) : json::object();
  }
  /// Root mean square over the moves of a straight (m) or a spin (rad), odometry against lidar.
  double error_of(const std::string& method, const json& parameters, const char* quantity) {
    const json moves = call(method, parameters).value("moves", json::array());
    double sum = 0.0;
    for (const auto& move : moves) {
      if (!move["error"].is_object()) {
        ADD_FAILURE() << "no lidar reference for " << move["move"];
        continue;
      }
      sum += std::pow(move["error"][quantity].get<double>(), 2);
    }
    EXPECT_FALSE(moves.empty());
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(moves.size(), 1)));
  }
  double straight_error() { return error_of("Straight", {{"distance", 1.0}}, "distance"); }
  double spin_error() { return error_of("Spin", {{"turns", 1.0}}, "yaw"); }

  void power_cycle() {
    robot_->reset_drive();
    client_.reset();
    service_.reset();
    linked_ = renewing_ = false;
    start_service();
    ASSERT_TRUE(run_until([this] { return ready(); }, 20.0)) << service_->status_json();
    acquire();
  }
  std::array<double, 3> truth() const {
    return {robot_->truth().left_diameter, robot_->truth().right_diameter, robot_->truth().track_width};
  }

  std::atomic<bool> solving_{false};
};

TEST_F(WholeLoop, SX_02_calibrated_values_are_true_stored_and_make_the_odometry_better) {
  acquire();
  const double straight_before = straight_error();
  const double spin_before = spin_error();
  const json result = call("Calibrate", {{"options", {{"quick", true}, {"effects", {"none"}}}}});
  const json calibration = result.value("calibration", json::object());
  ASSERT_TRUE(calibration.contains("verdict")) << result;
  EXPECT_NE(calibration["verdict"], "refused") << calibration["reasons"];
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const auto& parameter = calibration["parameters"][kNames.at(i)];
    const double true_value = truth().at(i);
    const double bound = std::max(3.0 * parameter["std"].get<double>(), 0.003 * true_value);
    EXPECT_NEAR(parameter["value"].get<double>(), true_value, bound) << kNames.at(i);
    std::printf("%-21s true %.5f found %.5f +- %.5f m\n", kNames.at(i), true_value,
                parameter["value"].get<double>(), parameter["std"].get<double>());
  }
  EXPECT_EQ(call("Apply", {{"calibration", calibration}})["outcome"], "committed");
  power_cycle();
  for (std::size_t i = 0; i < kNames.size(); ++i)
    EXPECT_NEAR(1e-6 * robot_->node().geometry_in_ram().at(i),
                calibration["parameters"][kNames.at(i)]["value"].get<double>(), 1e-6);
  const double straight_after = straight_error();
  const double spin_after = spin_error();
  std::printf("straight %.1f -> %.1f mm, spin %.3f -> %.3f deg\n", 1e3 * straight_before,
              1e3 * straight_after, 57.29578 * spin_before, 57.29578 * spin_after);
  EXPECT_LT(straight_after, 0.5 * straight_before);
  EXPECT_LT(spin_after, 0.5 * spin_before);
}

}  // namespace
}  // namespace odomcalib
