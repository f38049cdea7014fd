// Straight lines, turns on the spot and squares of the simulated robot, as a person at the robot drives them:
// the service in virtual time, and what the command line makes of its answers.
#include <cstdio>

#include "calib/classical/geometry_errors.hpp"
#include "daemon/cli/manual_moves.hpp"
#include "tests/integration/service_loop.hpp"

namespace odomcalib {
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
    for (const auto& [name, q] : proposal.parameters) values[name] = q.value;
    ASSERT_TRUE(run_until([this] { return ready(); }, 10.0)) << "values are written while the axes are off";
    run(0.5);
    TestClient caller(folder_ / "control");
    caller.call("SetParameters", {{"lease", lease_}, {"values", values}}, true);
    const auto reply = wait_reply(caller, 60.0);
    EXPECT_TRUE(reply.error.empty()) << reply.parameters;
  }
  const sim::Geometry& truth() const { return robot_->truth(); }
  static double value(const cli::Proposal& proposal, const std::string& name) {
    for (const auto& [key, q] : proposal.parameters)
      if (key == name) return q.value;
    ADD_FAILURE() << name;
    return 0.0;
  }
  static void show(const cli::Proposal& proposal, const std::vector<double>& truth) {
    for (std::size_t k = 0; k < proposal.parameters.size(); ++k) {
      const auto& [name, q] = proposal.parameters[k];
      std::printf("%-21s true %.6f found %.6f +- %.6f: %+.4f %%, %+.2f sigmas\n", name.c_str(), truth[k],
                  q.value, q.std, 100.0 * (q.value / truth[k] - 1.0), (q.value - truth[k]) / q.std);
    }
  }
};

TEST_F(Manual, S1_03_S1_04_three_repetitions_give_the_lengths_within_a_thousandth) {
  acquire();
  cli::DrivenMoves lines;
  for (int k = 0; k < 3; ++k) drive(lines, "Straight", {{"distance", 1.0}});
  const auto straight = cli::straight_proposal(lines, {});
  ASSERT_TRUE(straight) << straight.error().text();
  show(straight.value(), {truth().left_diameter, truth().right_diameter});
  EXPECT_NEAR(value(straight.value(), "left_wheel_diameter") / truth().left_diameter, 1.0, 1e-3);
  EXPECT_NEAR(value(straight.value(), "right_wheel_diameter") / truth().right_diameter, 1.0, 1e-3);
  write(straight.value());
  cli::DrivenMoves turns;
  for (int k = 0; k < 3; ++k) drive(turns, "Spin", {{"turns", 1.0}});
  const auto spin = cli::spin_proposal(turns, {});
  ASSERT_TRUE(spin) << spin.error().text();
  show(spin.value(), {truth().track_width});
  EXPECT_NEAR(value(spin.value(), "track_width") / truth().track_width, 1.0, 1e-3);
  for (std::size_t k = 0; k < 2; ++k) {
    const auto& q = straight.value().parameters[k].second;
    EXPECT_LT(std::abs(q.value - (k == 0 ? truth().left_diameter : truth().right_diameter)), 3.0 * q.std);
  }
  const double scale =
      (value(straight.value(), "left_wheel_diameter") + value(straight.value(), "right_wheel_diameter")) /
      (truth().left_diameter + truth().right_diameter);
  const auto& width = spin.value().parameters[0].second;
  EXPECT_LT(std::abs(width.value - scale * truth().track_width), 3.0 * width.std)
      << "but for the error of the diameters";
  write(spin.value());
  // What odometry says of a metre and of a turn, beside the true poses.
  const sim::Pose start = robot_->pose();
  cli::DrivenMoves metre;
  drive(metre, "Straight", {{"distance", 1.0}, {"one_way", true}});
  const sim::Pose there = robot_->pose();
  EXPECT_NEAR(std::hypot(there.x - start.x, there.y - start.y), metre.moves[0]["odometry"][0].get<double>(),
              1e-3);
  cli::DrivenMoves turn;
  drive(turn, "Spin", {{"turns", 1.0}, {"direction", "ccw"}});
  const double error =
      std::remainder(robot_->pose().yaw - there.yaw - turn.moves[0]["odometry"][2].get<double>(), 2.0 * M_PI);
  EXPECT_NEAR(error, 0.0, 0.1 * M_PI / 180.0);
  std::printf(
      "a metre: %+.2f mm, a turn: %+.3f deg\n",
      1e3 * (std::hypot(there.x - start.x, there.y - start.y) - metre.moves[0]["odometry"][0].get<double>()),
      error * 180.0 / M_PI);
}

TEST_F(Manual, S1_03_a_tape_gives_the_mean_of_the_diameters) {
  acquire();
  cli::DrivenMoves driven;
  std::vector<double> read;
  for (int k = 0; k < 3; ++k) {
    const sim::Pose from = robot_->pose();
    drive(driven, "Straight", {{"distance", 1.0}, {"one_way", true}});
    const sim::Pose to = robot_->pose();
    // A tape is read to a millimetre.
    read.push_back(1e-3 * std::round(1e3 * std::hypot(to.x - from.x, to.y - from.y)));
    drive(driven, "Straight", {{"distance", -1.0}, {"one_way", true}});
  }
  const auto proposal = cli::straight_proposal(driven, read);
  ASSERT_TRUE(proposal) << proposal.error().text();
  EXPECT_EQ(proposal.value().used, 3U) << "the ways back were not measured";
  const double mean = (truth().left_diameter + truth().right_diameter) / 2.0;
  const double found =
      (value(proposal.value(), "left_wheel_diameter") + value(proposal.value(), "right_wheel_diameter")) /
      2.0;
  EXPECT_NEAR(found / mean, 1.0, 1e-3);
  EXPECT_FALSE(cli::straight_proposal(driven, {1.0, 1.0})) << "two values for three ways";
}

TEST_F(Manual, S1_04_a_mark_on_the_floor_gives_the_track_width) {
  acquire();
  cli::DrivenMoves driven;
  drive(driven, "Spin", {{"turns", 1.0}});
  std::vector<double> read;
  for (const auto& move : driven.moves) {
    // By how much the wheels really turned it, read to a tenth of a degree.
    const double turn = (0.5 * truth().right_diameter * move["wheels"][1].get<double>() -
                         0.5 * truth().left_diameter * move["wheels"][0].get<double>()) /
                        truth().track_width;
    read.push_back(M_PI / 1800.0 * std::round(std::abs(turn) * 1800.0 / M_PI));
  }
  const auto proposal = cli::spin_proposal(driven, read);
  ASSERT_TRUE(proposal) << proposal.error().text();
  const double scale = (truth().left_diameter + truth().right_diameter) / 0.3;
  EXPECT_NEAR(value(proposal.value(), "track_width") * scale / truth().track_width, 1.0, 1e-3)
      << "but for the error of the diameters, which come first";
}

class Squares : public Manual, public testing::WithParamInterface<std::uint64_t> {
 protected:
  void adjust(sim::SimRobotOptions& options) override {
    options.truth = sim::draw_truth(options.nominal, GetParam());
  }
};

// The diameters' common scale first, as people are told.
TEST_P(Squares, S1_07_driven_both_ways_give_E_d_and_E_b_within_three_deviations) {
  acquire();
  cli::DrivenMoves lines;
  drive(lines, "Straight", {{"distance", 1.0}});
  const auto straight = cli::straight_proposal(lines, {1.0});
  ASSERT_TRUE(straight);
  auto scaled = straight.value();
  for (auto& [name, q] : scaled.parameters) q.value = (truth().left_diameter + truth().right_diameter) / 2.0;
  write(scaled);
  cli::DrivenMoves driven;
  drive(driven, "Straight", {{"distance", 1.0}, {"square", true}, {"repeat", 5}});
  const auto square = cli::square_proposal(driven, 1.0);
  ASSERT_TRUE(square) << square.error().text();
  show(square.value(), {truth().left_diameter, truth().right_diameter, truth().track_width});
  const std::array expected{truth().right_diameter / truth().left_diameter, truth().track_width / 0.4};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto& [name, q] = square.value().errors[k];
    EXPECT_LT(std::abs(q.value - expected[k]), 3.0 * q.std)
        << name << " " << q.value << " for " << expected[k];
    EXPECT_LT(q.std, 1e-3) << name;
  }
}
INSTANTIATE_TEST_SUITE_P(Robots, Squares, testing::Range<std::uint64_t>(1, 21));

}  // namespace
}  // namespace odomcalib
