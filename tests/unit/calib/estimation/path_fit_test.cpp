// Synthetic drives: exact poses with drawn errors, wheels with drawn slip.
#include "calib/estimation/path_fit.hpp"
#include "calib/vehicle/step_context.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>

namespace odomcalib::calib::estimation::path_fit_test {
namespace {

const wheels::BaseParameters kTruth{0.0752, 0.0748, 0.405, {0.11, -0.02, 0.4}};
constexpr double kPlaceError = 5e-4;  // m and rad
constexpr double kSlip = 3e-4;        // m per square root of a metre, each wheel

struct Drive {
  std::unique_ptr<vehicle::DriveModel> model;
  PathData data;
};

using Speeds = std::function<std::array<double, 2>(double t)>;  // rad/s, left and right

/// Wheel speeds change every second where none are given; a place every 0.1 s.
/// @param left_radius of the left wheel over the true one, at a time
Drive make_drive(
    unsigned seed, double place_error, double slip, const Speeds& speeds = {},
    const std::function<double(double t)>& left_radius = [](double) { return 1.0; }) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> speed(-5.0, 5.0);
  constexpr double kStep = 0.02;  // s
  wheels::WheelTrack track;
  math::Pose base;
  double left = 0.0, right = 0.0, left_speed = 0.0, right_speed = 0.0;
  Drive drive;
  for (int k = 0; k < 5000; ++k) {
    track.t.push_back(kStep * k);
    track.left.push_back(left);
    track.right.push_back(right);
    track.segment.push_back(0);
    if (k % 5 == 0) {
      const math::Pose sensor = compose(base, kTruth.mount);
      drive.data.scans.push_back(
          {kStep * k,
           {sensor.x + place_error * normal(engine), sensor.y + place_error * normal(engine),
            sensor.yaw + place_error * normal(engine)},
           Eigen::Matrix3d::Identity() * kPlaceError * kPlaceError});
    }
    if (speeds) {
      left_speed = speeds(kStep * k)[0];
      right_speed = speeds(kStep * k)[1];
    } else if (k % 50 == 0) {
      left_speed = speed(engine);
      right_speed = speed(engine);
    }
    left += kStep * left_speed;
    right += kStep * right_speed;
    const auto rolled = [&](double radius, double rate) {
      const double travel = radius * kStep * rate;
      return travel + slip * std::sqrt(std::abs(travel)) * normal(engine);
    };
    base = compose(base, wheels::wheel_arc(rolled(kTruth.left_radius * left_radius(kStep * k), left_speed),
                                           rolled(kTruth.right_radius, right_speed), kTruth.track_width));
  }
  wheels::BaseParameters nominal = kTruth;
  auto context = vehicle::make_context(track, nominal);
  drive.model = std::make_unique<vehicle::DriveModel>(std::move(track), std::move(context));
  drive.data.model = drive.model.get();
  return drive;
}

Eigen::VectorXd start() { return vehicle::to_vector({0.0765, 0.0735, 0.41, {0.10, 0.0, 0.38}}); }

PathFitOptions free_options() {
  return {{}, Eigen::MatrixXd::Zero(vehicle::kBaseCount, vehicle::kBaseCount)};
}

TEST(PathFit, exact_places_and_ideal_wheels_give_the_truth) {
  const Drive drive = make_drive(1, 0.0, 0.0);
  const auto fit = fit_path({&drive.data, 1}, {}, start(), free_options());
  ASSERT_TRUE(fit.ok()) << fit.error().text();
  const Eigen::VectorXd truth = vehicle::to_vector(kTruth);
  for (Eigen::Index k = 0; k < vehicle::kBaseCount; ++k)
    EXPECT_NEAR(fit.value().parameters(k), truth(k), 1e-6) << k;
}

TEST(PathFit, stated_deviations_are_the_scatter_and_both_noises_are_told_apart) {
  constexpr unsigned kRuns = 30;
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(vehicle::kBaseCount);
  double place = 0.0, forward = 0.0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const Drive drive = make_drive(seed, kPlaceError, kSlip);
    const auto fit = fit_path({&drive.data, 1}, {}, start(), free_options());
    ASSERT_TRUE(fit.ok()) << fit.error().text();
    const Eigen::VectorXd error = fit.value().parameters - vehicle::to_vector(kTruth);
    squares += error.cwiseAbs2().cwiseQuotient(fit.value().covariance.diagonal()) / kRuns;
    place += fit.value().noise[0].place / kRuns;
    forward += fit.value().noise[0].forward / kRuns;
  }
  for (Eigen::Index k = 0; k < vehicle::kBaseCount; ++k) {
    EXPECT_GT(squares(k), 0.4) << "parameter " << k << ", first seed 1";
    EXPECT_LT(squares(k), 2.0) << "parameter " << k << ", first seed 1";
  }
  EXPECT_NEAR(place, 1.0, 0.1);
  EXPECT_NEAR(forward, kSlip / std::sqrt(2.0), 0.2 * kSlip);
}

TEST(PathFit, a_robot_that_is_pushed_and_places_that_are_false_do_not_spoil_it) {
  Drive drive = make_drive(3, kPlaceError, kSlip);
  for (std::size_t k = 500; k < drive.data.scans.size(); ++k) {  // carried 0.3 m and turned
    math::Pose& pose = drive.data.scans[k].pose;
    pose = compose(math::Pose{0.3, 0.1, 0.5}, pose);
  }
  for (std::size_t k = 100; k < 400; k += 50) drive.data.scans[k].pose.x += 0.05;
  const auto fit = fit_path({&drive.data, 1}, {}, start(), free_options());
  ASSERT_TRUE(fit.ok()) << fit.error().text();
  EXPECT_GE(fit.value().discarded, 7U);
  const Eigen::VectorXd error = fit.value().parameters - vehicle::to_vector(kTruth);
  for (Eigen::Index k = 0; k < vehicle::kBaseCount; ++k)
    EXPECT_LT(std::abs(error(k)), 4.0 * std::sqrt(fit.value().covariance(k, k))) << k;
}

TEST(PathFit, noise_of_the_wheels_is_by_the_way_that_each_of_them_rolls) {
  const Drive both = make_drive(5, kPlaceError, 10.0 * kSlip);
  const auto fit = fit_path({&both.data, 1}, {}, start(), free_options());
  ASSERT_TRUE(fit.ok()) << fit.error().text();
  EXPECT_NEAR(fit.value().noise[0].forward, 10.0 * kSlip / std::sqrt(2.0), 2.0 * kSlip);
}

TEST(PathFit, goes_over_no_gap_of_two_seconds_and_to_no_place_without_counts) {
  const auto links_of = [](const PathData& data) {
    const auto fit = fit_path({&data, 1}, {}, start(), free_options());
    EXPECT_TRUE(fit.ok()) << fit.error().text();
    return fit.value().used + fit.value().discarded;
  };
  const auto without = [](const PathData& data, std::ptrdiff_t count) {
    PathData less = data;
    less.scans.erase(less.scans.begin() + 400, less.scans.begin() + 400 + count);
    return less;
  };
  const Drive drive = make_drive(1, kPlaceError, kSlip);
  ASSERT_EQ(drive.data.scans.size(), 1000U);
  EXPECT_EQ(links_of(drive.data), 999U);
  EXPECT_EQ(links_of(without(drive.data, 18)), 981U) << "1.9 s";
  EXPECT_EQ(links_of(without(drive.data, 20)), 978U) << "2.1 s";
  PathData beyond = drive.data;
  beyond.scans.push_back(beyond.scans.back());
  beyond.scans.back().time = 100.02;
  EXPECT_EQ(links_of(beyond), 999U) << "the wheels are known up to 99.98 s";
}

TEST(PathFit, fixed_parameters_stay_and_the_others_are_found) {
  const Drive drive = make_drive(1, 0.0, 0.0);
  PathFitOptions options = free_options();
  options.fixed = {false, false, false, false, false, true};
  Eigen::VectorXd begin = start();
  begin(vehicle::kMountYaw) = kTruth.mount.yaw;
  const auto fit = fit_path({&drive.data, 1}, {}, begin, options);
  ASSERT_TRUE(fit.ok()) << fit.error().text();
  EXPECT_EQ(fit.value().parameters(vehicle::kMountYaw), kTruth.mount.yaw);
  EXPECT_EQ(fit.value().covariance.row(vehicle::kMountYaw).norm(), 0.0);
  EXPECT_NEAR(fit.value().parameters(vehicle::kTrackWidth), kTruth.track_width, 1e-6);
  EXPECT_GT(fit.value().covariance(vehicle::kTrackWidth, vehicle::kTrackWidth), 0.0);
}

/// The robot turns on the spot, each way for five seconds.
std::array<double, 2> on_the_spot(double t) {
  const double speed = std::fmod(t, 10.0) < 5.0 ? 2.0 : -2.0;
  return {-speed, speed};
}

TEST(PathFit, turns_on_the_spot_alone_are_refused) {
  const Drive drive = make_drive(1, 0.0, 0.0, on_the_spot);
  const auto fit = fit_path({&drive.data, 1}, {}, start(), free_options());
  ASSERT_FALSE(fit.ok());
  EXPECT_EQ(fit.error().code, ErrorCode::refused);
  EXPECT_NE(fit.error().what.find("does not determine"), std::string::npos) << fit.error().what;
  EXPECT_NE(fit.error().remedy.find("straight"), std::string::npos) << fit.error().remedy;
}

// With w rad/s ahead beside the turns, the smallest eigenvalue of the scaled normal matrix is 0.0555 w^2:
// 0.89e-12 and 1.12e-12 here. Where the axle has its middle, and where the lidar looks, is known.
TEST(PathFit, an_eigenvalue_of_1e_minus_12_is_the_least_that_determines_all) {
  const auto is_determined = [](double ahead) {
    const Drive drive = make_drive(1, 0.0, 0.0, [ahead](double t) {
      const auto turning = on_the_spot(t);
      return std::array{turning[0] + ahead, turning[1] + ahead};
    });
    PathFitOptions options = free_options();
    options.fixed = {false, false, false, false, true, true};
    return fit_path({&drive.data, 1}, {}, vehicle::to_vector(kTruth), options).ok();
  };
  EXPECT_FALSE(is_determined(4.0e-6));
  EXPECT_TRUE(is_determined(4.5e-6));
}

/// Deviations of the parameters that a fit states.
Eigen::VectorXd stated(const Drive& drive) {
  const auto fit = fit_path({&drive.data, 1}, {}, vehicle::to_vector(kTruth), free_options());
  EXPECT_TRUE(fit.ok()) << fit.error().text();
  return fit.value().covariance.diagonal().cwiseSqrt();
}

// The left wheel is larger by 0.5 % for six seconds, and smaller for the next six: in single motions that is
// little beside the errors of the places. By single motions alone the deviation would be 3.2 times what it is
// without.
TEST(PathFit, errors_that_go_together_count_together) {
  const auto swaying = [](double t) { return std::fmod(t, 12.0) < 6.0 ? 1.005 : 0.995; };
  const Eigen::VectorXd alone = stated(make_drive(4, kPlaceError, kSlip));
  const Eigen::VectorXd together = stated(make_drive(4, kPlaceError, kSlip, {}, swaying));
  EXPECT_GT(together(vehicle::kLeftRadius), 4.5 * alone(vehicle::kLeftRadius));
}

/// The robot moves for three seconds in ten, differently each time.
std::array<double, 2> mostly_at_rest(double t) {
  if (std::fmod(t, 10.0) > 3.0) return {0.0, 0.0};
  return {3.0 * std::cos(1.7 * std::floor(t / 10.0)), 3.0 * std::sin(2.9 * std::floor(t / 10.0) + 0.4)};
}

// Places scatter by eight times their stated deviations, of which the noise may take four. The figures are
// those of a variance above two; a variance half as large would make each of them smaller by a root of two.
TEST(PathFit, errors_that_no_noise_explains_widen_what_is_stated) {
  const Eigen::VectorXd found = stated(make_drive(6, 8.0 * kPlaceError, 0.0, mostly_at_rest));
  EXPECT_NEAR(found(vehicle::kLeftRadius), 2.66e-4, 0.1 * 2.66e-4);
  EXPECT_NEAR(found(vehicle::kRightRadius), 2.63e-4, 0.1 * 2.63e-4);
  EXPECT_NEAR(found(vehicle::kTrackWidth), 1.42e-3, 0.1 * 1.42e-3);
  EXPECT_NEAR(found(vehicle::kMountX), 4.25e-4, 0.1 * 4.25e-4);
}

TEST(PathFit, a_handful_of_places_is_refused) {
  Drive drive = make_drive(1, kPlaceError, kSlip);
  drive.data.scans.resize(30);
  EXPECT_FALSE(fit_path({&drive.data, 1}, {}, start(), free_options()).ok());
}

}  // namespace
}  // namespace odomcalib::calib::estimation::path_fit_test
