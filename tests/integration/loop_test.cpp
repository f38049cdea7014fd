// The whole loop in virtual time: drive, solve, write back, power cycle, drive again: the error went down.
#include "tests/integration/whole_loop.hpp"

namespace odomcalib::loop_test {
namespace {

TEST_F(WholeLoop, SX_02_calibrated_values_are_true_stored_and_make_the_odometry_better) {
  acquire();
  const double straight_before = straight_error();
  const double spin_before = spin_error();
  const json result = call("Calibrate", {{"options", {{"quick", true}, {"effects", {"none"}}}}});
  const json calibration = result.value("calibration", json::object());
  ASSERT_TRUE(calibration.contains("verdict")) << result;
  EXPECT_NE(calibration["verdict"], "refused") << calibration["reasons"];
  EXPECT_EQ(calibration["robot"].value("controller_id", ""), "0xfee/0xd15/4242") << calibration["robot"];
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const auto& parameter = calibration["parameters"][kNames.at(i)];
    const double true_value = truth().at(i);
    const double bound = std::max(3.0 * parameter["std"].get<double>(), 0.003 * true_value);
    EXPECT_NEAR(parameter["value"].get<double>(), true_value, bound) << kNames.at(i);
    std::printf("%-21s true %.5f found %.5f +- %.5f m\n", kNames.at(i), true_value,
                parameter["value"].get<double>(), parameter["std"].get<double>());
  }
  EXPECT_EQ(call("Apply", {{"calibration", calibration}, {"of_this_robot", true}})["outcome"], "committed");
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
}  // namespace odomcalib::loop_test
