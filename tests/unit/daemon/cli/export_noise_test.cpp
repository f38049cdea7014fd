// Filters that take the exported noise, beside simulated drives whose wheels slip by chance: their normalised
// innovations are those of a filter that knows how far it may be off.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <sstream>

#include "calib/math/se2.hpp"
#include "calib/odometry/odometry.hpp"
#include "calib/odometry/uncertainty.hpp"
#include "daemon/cli/export_configurations.hpp"
#include "daemon/cli/export_noise.hpp"
#include "tests/sim/world/body.hpp"
#include "tests/sim/world/drives.hpp"

namespace odomcalib::cli::export_noise_test {
namespace {

using calib::math::Pose;

constexpr double kSlip = 2e-3, kTrack = 0.4, kPeriod = 0.02;
constexpr double kPlace = 5e-4, kHeading = 5e-4;  // m, rad: deviations of the filter's measurements
const RobotDescription kRobot{0.15, 0.15, kTrack, 16384.0, std::nullopt, "", ""};

Calibration calibration_of(double slip) {
  Calibration calibration = calib::odometry::nominal_calibration(kRobot);
  calibration.verdict = Verdict::accepted;
  calibration.contact_noise = calib::odometry::entry_of({slip * M_SQRT1_2, 0.0, slip * M_SQRT2 / kTrack});
  return calibration;
}

/// The number after a name.
double value_in(const std::string& text, const std::string& name) {
  const auto at = text.find(name + ":");
  EXPECT_NE(at, std::string::npos) << name;
  return at == std::string::npos ? NAN : std::stod(text.substr(at + name.size() + 1));
}

/// Increments of odometry, and the true pose at the end of each.
struct Step {
  Pose motion, truth;
};

/// Straights and turns on the spot.
std::vector<sim::Manoeuvre> to_and_fro() {
  std::vector<sim::Manoeuvre> moves;
  for (int leg = 0; leg < 12; ++leg) {
    moves.push_back({0.4, 0.0, 3.0});
    moves.push_back({0.0, leg % 3 == 0 ? -0.8 : 0.8, 2.0});
  }
  return moves;
}

/// A drive, cut where `is_due` says.
template <typename Due>
std::vector<Step> drive(std::uint64_t seed, Due is_due,
                        const std::vector<sim::Manoeuvre>& moves = to_and_fro()) {
  sim::Geometry truth;
  sim::BodyOptions options;
  options.slip_noise = kSlip;
  sim::Body body(truth, options, seed);
  calib::odometry::Odometry odometry(calibration_of(kSlip));
  const sim::Drive command = follow(truth, moves);
  std::vector<Step> steps;
  Pose from;
  while (body.time() < total_duration(moves)) {
    const PoseSample at = odometry.update({body.time(), body.counts()[0], body.counts()[1], 0});
    const Pose motion = between(from, Pose{at.x, at.y, at.yaw});
    if (is_due(motion)) {
      steps.push_back({motion, {body.pose().x, body.pose().y, body.pose().yaw}});
      from = {at.x, at.y, at.yaw};
    }
    const sim::WheelCommand wanted = command(body.time(), {});
    body.command(wanted.left, wanted.right);
    for (int k = 0; k < 20; ++k) body.advance();
  }
  return steps;
}

/// A Kalman filter that is told the true pose, with noise, after so many steps.
/// @param noise_of covariance of a step's motion, in the frame at its begin
/// @return sum of the normalised squared innovations, and their degrees of freedom
template <typename Noise>
std::pair<double, double> innovations(const std::vector<Step>& steps, std::uint64_t seed, Noise noise_of,
                                      int every) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> unit(0.0, 1.0);
  const Eigen::Matrix3d measurement = Eigen::Vector3d(kPlace, kPlace, kHeading).cwiseAbs2().asDiagonal();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Eigen::Vector3d state = Eigen::Vector3d::Zero();
  double sum = 0.0, freedom = 0.0;
  int count = 0;
  for (const Step& step : steps) {
    const double c = std::cos(state(2)), s = std::sin(state(2));
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity(), carried = turn;
    turn.topLeftCorner<2, 2>() << c, -s, s, c;
    const Eigen::Vector3d moved = turn * Eigen::Vector3d(step.motion.x, step.motion.y, step.motion.yaw);
    carried(0, 2) = -moved(1);
    carried(1, 2) = moved(0);
    state += moved;
    covariance = carried * covariance * carried.transpose() + turn * noise_of(step.motion) * turn.transpose();
    if (++count % every != 0) continue;
    Eigen::Vector3d off(step.truth.x + kPlace * unit(random) - state(0),
                        step.truth.y + kPlace * unit(random) - state(1),
                        std::remainder(step.truth.yaw + kHeading * unit(random) - state(2), 2.0 * M_PI));
    const Eigen::Matrix3d expected = covariance + measurement;
    sum += off.dot(expected.inverse() * off);
    freedom += 3.0;
    const Eigen::Matrix3d gain = covariance * expected.inverse();
    state += gain * off;
    covariance = (Eigen::Matrix3d::Identity() - gain) * covariance;
  }
  return {sum, freedom};
}

/// Number of 100 drives whose sum lies in the 95 % band of chi-squared, which so many terms make normal.
template <typename Due, typename Noise>
int count_in_band(Due is_due, Noise noise_of, int every) {
  int inside = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const auto [sum, freedom] = innovations(drive(seed, is_due), seed, noise_of, every);
    if (std::abs(sum - freedom) < 1.96 * std::sqrt(2.0 * freedom)) ++inside;
  }
  std::cout << inside << " of 100 drives lie in the band of 95 %\n";
  return inside;
}

TEST(ExportNoise, of_amcl_makes_innovations_that_are_as_large_as_they_should_be) {
  const auto text = configuration(calibration_of(kSlip), "amcl", "cal.json");
  ASSERT_TRUE(text.ok()) << text.error().text();
  const double a1 = value_in(text.value(), "alpha1"), a2 = value_in(text.value(), "alpha2"),
               a3 = value_in(text.value(), "alpha3"), a4 = value_in(text.value(), "alpha4");
  const double least_way = value_in(text.value(), "update_min_d"),
               least_turn = value_in(text.value(), "update_min_a");
  const auto is_due = [&](const Pose& motion) {
    return std::hypot(motion.x, motion.y) >= least_way || std::abs(motion.yaw) >= least_turn;
  };
  // nav2_amcl, differential_motion_model.cpp: a turn, a way and a turn, each with a noise of its own.
  const auto noise_of = [&](const Pose& motion) {
    const double way = std::hypot(motion.x, motion.y);
    const double first = way < 0.01 ? 0.0 : std::atan2(motion.y, motion.x), second = motion.yaw - first;
    Eigen::Matrix3d by = Eigen::Matrix3d::Zero();
    by.col(0) = Eigen::Vector3d(-motion.y, motion.x, 1.0);
    by.col(1) = Eigen::Vector3d(std::cos(first), std::sin(first), 0.0);
    by.col(2) = Eigen::Vector3d(0.0, 0.0, 1.0);
    const Eigen::Vector3d variances(a1 * first * first + a2 * way * way,
                                    a3 * way * way + a4 * (first * first + second * second),
                                    a1 * second * second + a2 * way * way);
    return Eigen::Matrix3d(by * variances.asDiagonal() * by.transpose());
  };
  const int inside = count_in_band(is_due, noise_of, 1);
  EXPECT_GE(inside, 90);
  EXPECT_LE(inside, 98);
}

TEST(ExportNoise, of_robot_localization_makes_innovations_that_are_as_large_as_they_should_be) {
  const auto text = configuration(calibration_of(kSlip), "robot_localization", "cal.json");
  ASSERT_TRUE(text.ok()) << text.error().text();
  std::istringstream numbers(text.value().substr(text.value().find('[') + 1));
  std::vector<double> diagonal;
  for (std::string word; std::getline(numbers, word, ',');) diagonal.push_back(std::stod(word));
  ASSERT_EQ(diagonal.size(), 6U);
  const auto is_due = [](const Pose& /*motion*/) { return true; };
  // The stated speed of the rims scaled to that of the drive.
  const auto noise_of = [&](const Pose& motion) {
    const double rolled = std::max(std::hypot(motion.x, motion.y), 0.5 * kTrack * std::abs(motion.yaw));
    const double share_of_stated = rolled / (kPeriod * 0.5);
    const double way_of_variance = kPeriod * kPeriod * share_of_stated;
    Eigen::Matrix3d noise = Eigen::Matrix3d::Zero();
    noise(0, 0) = diagonal[0] * way_of_variance;
    noise(1, 1) = diagonal[1] * way_of_variance;
    noise(2, 2) = diagonal[5] * way_of_variance;
    return noise;
  };
  const int inside = count_in_band(is_due, noise_of, 10);
  EXPECT_GE(inside, 90);
  EXPECT_LE(inside, 98);
}

/// Treatment of odometry by slam_toolbox's matcher, by its exported parameters.
struct KartoMatcher {
  double step, smear, range;      ///< m
  double distance, angle;         ///< deviations of the penalties, m and rad
  double place_match, yaw_match;  ///< variances of a match

  explicit KartoMatcher(const std::string& text)
      : step(value_in(text, "minimum_travel_distance")),
        smear(value_in(text, "correlation_search_space_smear_deviation")),
        range(3.0),
        distance(value_in(text, "distance_variance_penalty")),
        angle(value_in(text, "angle_variance_penalty")),
        place_match(std::pow(value_in(text, "correlation_search_space_resolution"), 2) / 6.0),
        yaw_match(std::pow(value_in(text, "fine_search_angle_offset"), 2) / 6.0) {}

  /// Deviations of the pose before a match, as docs/user/library.md has it.
  [[nodiscard]] double place_before() const { return std::pow(distance / smear, 2) / 0.4 * place_match; }
  [[nodiscard]] double yaw_before() const { return std::pow(angle * range / smear, 2) / 0.4 * yaw_match; }
};

/// Sums of the normalised squared innovations of place and heading in a filter whose gain stays what it is.
std::pair<double, double> innovations_of(const KartoMatcher& matcher, const std::vector<Step>& steps,
                                         std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> unit(0.0, 1.0);
  const double place = std::sqrt(matcher.place_match), yaw = std::sqrt(matcher.yaw_match);
  const double all_place = matcher.place_before() + matcher.place_match,
               all_yaw = matcher.yaw_before() + matcher.yaw_match;
  Pose at;
  double sum_place = 0.0, sum_yaw = 0.0;
  for (const Step& step : steps) {
    at = compose(at, step.motion);
    const double x = step.truth.x + place * unit(random) - at.x,
                 y = step.truth.y + place * unit(random) - at.y,
                 turn = std::remainder(step.truth.yaw + yaw * unit(random) - at.yaw, 2.0 * M_PI);
    sum_place += (x * x + y * y) / all_place;
    sum_yaw += turn * turn / all_yaw;
    const double gain = matcher.place_before() / all_place;
    at = {at.x + gain * x, at.y + gain * y, at.yaw + matcher.yaw_before() / all_yaw * turn};
  }
  return {sum_place, sum_yaw};
}

TEST(ExportNoise, of_slam_toolbox_makes_innovations_that_are_as_large_as_they_should_be) {
  const auto text = configuration(calibration_of(kSlip), "slam_toolbox", "cal.json");
  ASSERT_TRUE(text.ok()) << text.error().text();
  const KartoMatcher matcher(text.value());
  const auto is_due = [&](const Pose& motion) { return std::hypot(motion.x, motion.y) >= matcher.step; };
  int places = 0, headings = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const auto steps = drive(seed, is_due, {{0.5, 0.0, 60.0}});
    const auto [place, yaw] = innovations_of(matcher, steps, seed);
    const auto count = static_cast<double>(steps.size());
    if (std::abs(place - 2.0 * count) < 1.96 * std::sqrt(4.0 * count)) ++places;
    if (std::abs(yaw - count) < 1.96 * std::sqrt(2.0 * count)) ++headings;
  }
  std::cout << places << " and " << headings << " of 100 drives lie in the band of 95 %\n";
  EXPECT_GE(places, 90);
  EXPECT_LE(places, 98);
  EXPECT_GE(headings, 90);
  EXPECT_LE(headings, 98);
}

// Karto's Mapper.cpp: the response falls with the smear of its grid, and is multiplied by the penalty.
TEST(ExportNoise, of_slam_toolbox_makes_its_matcher_weigh_odometry_as_a_filter_does) {
  const auto text = configuration(calibration_of(kSlip), "slam_toolbox", "cal.json");
  ASSERT_TRUE(text.ok()) << text.error().text();
  const KartoMatcher matcher(text.value());
  const auto gain = [](double smear, double penalty, double match) {
    double best = 0.0, at = 0.0;
    for (double pose = 0.0; pose <= match; pose += 1e-3 * match) {
      const double response = std::exp(-0.5 * std::pow((match - pose) / smear, 2)) *
                              std::max(1.0 - 0.2 * std::pow(pose / penalty, 2), 0.5);
      if (response > best) best = response, at = pose;
    }
    return at / match;
  };
  const double place = matcher.place_before(), yaw = matcher.yaw_before();
  EXPECT_NEAR(gain(matcher.smear, matcher.distance, 2e-3), place / (place + matcher.place_match), 0.02);
  EXPECT_NEAR(gain(matcher.smear / matcher.range, matcher.angle, 1e-3), yaw / (yaw + matcher.yaw_match),
              0.02);
}

TEST(ExportNoise, a_calibration_that_states_none_says_so) {
  const auto text = configuration(calib::odometry::nominal_calibration(kRobot), "amcl", "cal.json");
  ASSERT_FALSE(text.ok());
  Calibration silent = calibration_of(kSlip);
  silent.contact_noise.reset();
  const auto none = amcl_yaml(silent, "cal.json");
  ASSERT_FALSE(none.ok());
  EXPECT_NE(none.error().text().find("states no noise"), std::string::npos);
}

}  // namespace
}  // namespace odomcalib::cli::export_noise_test
