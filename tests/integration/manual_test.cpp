// Straight lines, turns on the spot and squares of the simulated robot, as a person at the robot drives them:
// the service in virtual time, and what the command line makes of its answers.
#include <cstdio>

#include "calib/classical/rest_to_rest.hpp"
#include "daemon/cli/manual_moves.hpp"
#include "tests/integration/service_loop.hpp"

namespace odomcalib::manual_test {
namespace {

class Manual : public ServiceLoop {
 protected:
  Calibrator calibrator() override { return make_calibrator(); }
  void drive(cli::DrivenMoves& driven, const std::string& method, json parameters) {
    TestClient caller(folder_ / "control");
    parameters["lease"] = lease_;
    caller.call(method, parameters, true);
    const auto reply = wait_reply(caller, 1200.0);
    ASSERT_TRUE(reply.error.empty()) << method << ": " << reply.parameters;
    const auto added = driven.add(nlohmann::ordered_json::parse(reply.parameters)["result"]);
    ASSERT_TRUE(added) << added.error().text();
  }
  /// As params set does it.
  void write(const cli::Proposal& proposal) {
    json values = json::object();
    for (const auto& [name, q] : proposal.entry.parameters) values[name] = q.value;
    ASSERT_TRUE(run_until([this] { return ready(); }, 10.0)) << "values are written while the axes are off";
    run(0.5);
    TestClient caller(folder_ / "control");
    caller.call("SetParameters", {{"lease", lease_}, {"values", values}}, true);
    const auto reply = wait_reply(caller, 60.0);
    EXPECT_TRUE(reply.error.empty()) << reply.parameters;
  }
  const sim::Geometry& truth() const { return robot_->truth(); }
  static double value(const cli::Proposal& proposal, const std::string& name) {
    for (const auto& [key, q] : proposal.entry.parameters)
      if (key == name) return q.value;
    ADD_FAILURE() << name;
    return 0.0;
  }
  /// Right to a thousandth, and within three deviations.
  static void expect_found(const cli::Proposal& proposal, const std::vector<double>& truth) {
    ASSERT_EQ(proposal.entry.parameters.size(), truth.size());
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const auto& [name, q] = proposal.entry.parameters[k];
      std::printf("%-21s true %.6f found %.6f +- %.6f: %+.4f %%, %+.2f sigmas\n", name.c_str(), truth[k],
                  q.value, q.std, 100.0 * (q.value / truth[k] - 1.0), (q.value - truth[k]) / q.std);
      EXPECT_NEAR(q.value / truth[k], 1.0, 1e-3) << name;
      EXPECT_LT(std::abs(q.value - truth[k]), 3.0 * q.std) << name;
    }
  }
};

/// One of the robots of the simulator's truths.
class OneRobot : public Manual, public testing::WithParamInterface<std::uint64_t> {
 protected:
  void adjust(sim::SimRobotOptions& options) override {
    options.truth = sim::draw_truth(options.nominal, GetParam());
  }
  double true_scale() const { return (truth().left_diameter + truth().right_diameter) / 0.3; }
  /// Compares a metre and a turn by odometry with the true poses.
  void expect_metre_and_turn() {
    const sim::Pose start = robot_->pose();
    cli::DrivenMoves metre;
    drive(metre, "Straight", {{"distance", 1.0}, {"one_way", true}});
    const sim::Pose there = robot_->pose();
    const double of_metre =
        std::hypot(there.x - start.x, there.y - start.y) - metre.moves[0]["odometry"][0].get<double>();
    EXPECT_NEAR(of_metre, 0.0, 1e-3);
    cli::DrivenMoves turn;
    drive(turn, "Spin", {{"turns", 1.0}, {"direction", "ccw"}});
    const double of_turn = std::remainder(
        robot_->pose().yaw - there.yaw - turn.moves[0]["odometry"][2].get<double>(), 2.0 * M_PI);
    EXPECT_NEAR(of_turn, 0.0, 0.1 * M_PI / 180.0);
    std::printf("a metre: %+.2f mm, a turn: %+.3f deg\n", 1e3 * of_metre, of_turn * 180.0 / M_PI);
  }
};

class Lengths : public OneRobot {};

TEST_P(Lengths,
       S1_03_S1_04_three_repetitions_by_lidar_are_right_to_a_thousandth_and_within_their_deviations) {
  acquire();
  cli::DrivenMoves lines;
  for (int k = 0; k < 3; ++k) drive(lines, "Straight", {{"distance", 1.0}});
  const auto straight = cli::straight_proposal(lines, {});
  ASSERT_TRUE(straight) << straight.error().text();
  expect_found(straight.value(), {truth().left_diameter, truth().right_diameter});
  write(straight.value());
  cli::DrivenMoves turns;
  for (int k = 0; k < 3; ++k) drive(turns, "Spin", {{"turns", 1.0}});
  const auto spin = cli::spin_proposal(turns, {});
  ASSERT_TRUE(spin) << spin.error().text();
  expect_found(spin.value(), {truth().track_width});
  write(spin.value());
  expect_metre_and_turn();
}

// A tape shows no heading: both wheels get the factor of their mean, and so the mean is what is right.
TEST_P(Lengths, S1_03_S1_04_a_tape_and_a_mark_on_the_floor_are_right_to_a_thousandth) {
  acquire();
  cli::DrivenMoves lines;
  std::vector<double> ways, angles;
  for (int k = 0; k < 3; ++k) {
    const sim::Pose from = robot_->pose();
    drive(lines, "Straight", {{"distance", 1.0}, {"one_way", true}});
    const sim::Pose to = robot_->pose();
    // A tape is read to a millimetre.
    ways.push_back(1e-3 * std::round(1e3 * std::hypot(to.x - from.x, to.y - from.y)));
    drive(lines, "Straight", {{"distance", -1.0}, {"one_way", true}});
  }
  EXPECT_FALSE(cli::straight_proposal(lines, {1.0, 1.0})) << "two values for three ways";
  const auto straight = cli::straight_proposal(lines, ways);
  ASSERT_TRUE(straight) << straight.error().text();
  EXPECT_EQ(straight.value().entry.used, 3U) << "the ways back were not measured";
  const double mean = 0.15 * true_scale();
  const double left = value(straight.value(), "left_wheel_diameter");
  const double right = value(straight.value(), "right_wheel_diameter");
  EXPECT_NEAR((left + right) / 2.0 / mean, 1.0, 1e-3);
  EXPECT_LT(std::abs((left + right) / 2.0 - mean), 3.0 * straight.value().entry.parameters[0].second.std);
  write(straight.value());
  cli::DrivenMoves turns;
  for (int k = 0; k < 3; ++k)
    for (const char* direction : {"ccw", "cw"}) {
      const double from = robot_->pose().yaw;
      drive(turns, "Spin", {{"turns", 1.0}, {"direction", direction}});
      const double told = turns.moves.back()["odometry"][2].get<double>();
      // A mark at the end of a lath is read to a tenth of a degree.
      const double turned = told + std::remainder(robot_->pose().yaw - from - told, 2.0 * M_PI);
      angles.push_back(M_PI / 1800.0 * std::round(std::abs(turned) * 1800.0 / M_PI));
    }
  const auto spin = cli::spin_proposal(turns, angles);
  ASSERT_TRUE(spin) << spin.error().text();
  expect_found(spin.value(), {truth().track_width});
  write(spin.value());
  expect_metre_and_turn();
}
INSTANTIATE_TEST_SUITE_P(Robots, Lengths, testing::Range<std::uint64_t>(1, 11));

class Squares : public OneRobot {};

// The diameters' common scale first, as people are told.
TEST_P(Squares, S1_07_driven_both_ways_give_E_d_and_E_b_within_three_deviations) {
  acquire();
  cli::DrivenMoves lines;
  for (int k = 0; k < 3; ++k) drive(lines, "Straight", {{"distance", 1.0}});
  const auto straight = cli::straight_proposal(lines, {});
  ASSERT_TRUE(straight) << straight.error().text();
  write(straight.value());
  cli::DrivenMoves driven;
  drive(driven, "Straight", {{"distance", 1.0}, {"square", true}, {"repeat", 3}});
  EXPECT_NEAR(cli::side_of(driven), 1.0, 0.02);
  const auto square = cli::square_proposal(driven, 1.0);
  ASSERT_TRUE(square) << square.error().text();
  expect_found(square.value(), {truth().left_diameter, truth().right_diameter, truth().track_width});
  const std::array expected{truth().right_diameter / truth().left_diameter, truth().track_width / 0.4};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto& [name, q] = square.value().entry.errors[k];
    std::printf("%s true %.6f found %.6f +- %.6f: %+.2f sigmas\n", name.c_str(), expected[k], q.value, q.std,
                (q.value - expected[k]) / q.std);
    EXPECT_LT(std::abs(q.value - expected[k]), 3.0 * q.std)
        << name << " " << q.value << " for " << expected[k];
    EXPECT_LT(q.std, 1e-3) << name;
  }
}
INSTANTIATE_TEST_SUITE_P(Robots, Squares, testing::Range<std::uint64_t>(1, 21));

class NamedRobot : public Manual {
 protected:
  void adjust(Config& config) override { config.robot.robot_id = "robot-A"; }
  control::Reply apply(const Calibration& calibration) {
    TestClient caller(folder_ / "control");
    caller.call("Apply", {{"lease", lease_}, {"calibration", json::parse(to_json(calibration))}});
    return wait_reply(caller, 60.0);
  }
};

TEST_F(NamedRobot, takes_the_lengths_that_it_was_driven_for_and_not_those_of_another_controller) {
  acquire();
  cli::DrivenMoves driven;
  drive(driven, "Straight", {{"distance", 1.0}});
  const auto proposal = cli::straight_proposal(driven, {});
  ASSERT_TRUE(proposal) << proposal.error().text();
  Calibration lengths = cli::calibration_of(proposal.value(), driven);
  EXPECT_EQ(lengths.robot.robot_id, "robot-A");
  EXPECT_EQ(lengths.robot.controller_id, "0xfee/0xd15/4242");
  EXPECT_TRUE(lengths.robot.lidar_pose);
  EXPECT_FALSE(lengths.robot.controller.empty());
  ASSERT_TRUE(lengths.driven);
  EXPECT_GT(lengths.driven->begin, 1.7e9 + 100.0) << "the clock's time when the service began";
  EXPECT_GT(lengths.driven->end, lengths.driven->begin);
  EXPECT_NE(lengths.next_step.find("odomcalibctl apply"), std::string::npos) << lengths.next_step;
  Calibration other = lengths;
  other.robot.controller_id = "0xfee/0xd15/1";
  EXPECT_NE(apply(other).parameters.find("was made with the controller"), std::string::npos);
  const auto reply = apply(lengths);
  EXPECT_TRUE(reply.error.empty()) << reply.parameters;
}

}  // namespace
}  // namespace odomcalib::manual_test
