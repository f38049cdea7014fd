// Drive, solve, write back, drive again, in virtual time; the solver takes the time that it takes.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "tests/integration/service_loop.hpp"

namespace odomcalib {

inline constexpr std::array kNames{"left_wheel_diameter", "right_wheel_diameter", "track_width"};

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
  control::Reply ask(const std::string& method, const json& parameters) {
    TestClient caller(folder_ / "control");
    return ask(caller, method, parameters);
  }
  control::Reply ask(TestClient& caller, const std::string& method, json parameters) {
    parameters["lease"] = lease_;
    caller.call(method, parameters, true);
    std::optional<control::Reply> reply;
    run_until(
        [&] {
          if (solving_) std::this_thread::sleep_for(std::chrono::milliseconds(2));
          return (reply = caller.reply()).has_value();
        },
        2000.0);
    EXPECT_TRUE(reply) << method << ": no reply";
    return reply.value_or(control::Reply{});
  }
  json call(const std::string& method, const json& parameters) {
    const auto reply = ask(method, parameters);
    EXPECT_EQ(reply.error, "") << method << ": " << reply.parameters;
    return json::parse(reply.parameters).value("result", json::object());
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
    renewing_ = false;
    start_service();
    ASSERT_TRUE(run_until([this] { return ready(); }, 20.0)) << service_->status_json();
    acquire();
  }
  std::array<double, 3> truth() const {
    return {robot_->truth().left_diameter, robot_->truth().right_diameter, robot_->truth().track_width};
  }

  std::atomic<bool> solving_{false};
};

}  // namespace odomcalib
