// Synthetic drives: exact poses with drawn errors, wheels with drawn slip.
#include "calib/estimation/path_fit.hpp"
#include "calib/vehicle/step_context.hpp"

#include <gtest/gtest.h>

#include <cmath>
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

/// Wheel speeds change every second; a place every 0.1 s.
Drive make_drive(unsigned seed, double place_error, double slip) {
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
    if (k % 50 == 0) {
      left_speed = speed(engine);
      right_speed = speed(engine);
    }
    left += kStep * left_speed;
    right += kStep * right_speed;
    const auto rolled = [&](double radius, double rate) {
      const double travel = radius * kStep * rate;
      return travel + slip * std::sqrt(std::abs(travel)) * normal(engine);
    };
    base = compose(base, wheels::wheel_arc(rolled(kTruth.left_radius, left_speed),
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

TEST(PathFit, a_handful_of_places_is_refused) {
  Drive drive = make_drive(1, kPlaceError, kSlip);
  drive.data.scans.resize(30);
  EXPECT_FALSE(fit_path({&drive.data, 1}, {}, start(), free_options()).ok());
}

}  // namespace
}  // namespace odomcalib::calib::estimation::path_fit_test
