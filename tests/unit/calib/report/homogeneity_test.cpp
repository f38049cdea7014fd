// Recordings of one robot are homogeneous as often as chance has it; one that differs is named with what
// differs, whatever the order.
#include "calib/report/homogeneity.hpp"

#include <string>

#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::report::homogeneity_test {
namespace {

using selection::FitTask;
using selection::kBase;
using selection::kSeed;
using selection::lively_model;

constexpr int kPairs = 240;  // of half a second

/// Measurements of a sensor on such a robot.
measurement::FitData driven(const vehicle::DriveModel& model, const wheels::BaseParameters& base,
                            unsigned seed) {
  std::vector<vehicle::Interval> intervals;
  intervals.reserve(kPairs);
  for (int k = 0; k < kPairs; ++k) intervals.push_back({0.513 + 0.5 * k, 1.013 + 0.5 * k});
  const Eigen::VectorXd p = vehicle::to_vector(base);
  const auto motions = model.predict(vehicle::as_span(p), {}, intervals);
  std::mt19937 engine(seed);
  std::normal_distribution<double> noise(0.0, 5e-4);
  measurement::FitData data{&model, {}};
  for (std::size_t k = 0; k < intervals.size(); ++k)
    data.pairs.push_back(
        {intervals[k],
         {motions[k].x + noise(engine), motions[k].y + noise(engine), motions[k].yaw + noise(engine)},
         Eigen::Vector3d::Constant(25e-8).asDiagonal(),
         false});
  return data;
}

/// @param left radius of the left wheel, per recording
std::vector<measurement::FitData> recordings(const vehicle::DriveModel& model,
                                             const std::vector<double>& left, unsigned seed) {
  std::vector<measurement::FitData> all;
  for (const double radius : left) {
    wheels::BaseParameters base = kBase;
    base.left_radius = radius;
    all.push_back(driven(model, base, seed++));
  }
  return all;
}

Homogeneity compared(const std::vector<measurement::FitData>& data) {
  auto fit = estimation::fit_joint(data, {}, vehicle::to_vector(kBase));
  EXPECT_TRUE(fit);
  std::vector<std::string> names;
  for (std::size_t k = 0; k < data.size(); ++k) names.push_back("drive" + std::to_string(k));
  const FitTask task{data, std::vector<bool>(vehicle::kBaseCount, false)};
  const auto found = homogeneity(task, {{}, std::move(fit).value()}, 0.0, names);
  EXPECT_TRUE(found);
  return found.value_or(Homogeneity{});
}

TEST(Homogeneity, holds_for_one_robot_at_the_level_that_the_verdict_asks) {
  constexpr unsigned kSets = 60;
  constexpr double kLevel = 1e-3;
  const vehicle::DriveModel model = lively_model();
  unsigned below = 0;
  for (unsigned set = 0; set < kSets; ++set) {
    const double r = kBase.left_radius;
    if (compared(recordings(model, {r, r, r}, kSeed + 10 * set)).p_value < kLevel) ++below;
  }
  EXPECT_LE(below, 1U) << "of " << kSets << " sets, seeds from " << kSeed;
}

TEST(Homogeneity, names_the_recording_and_the_parameter_that_differ) {
  const vehicle::DriveModel model = lively_model();
  for (std::size_t odd = 0; odd < 5; ++odd) {
    std::vector<double> left(5, kBase.left_radius);
    left[odd] *= 1.003;
    const Homogeneity found = compared(recordings(model, left, kSeed + 100));
    EXPECT_LT(found.p_value, 1e-6);
    EXPECT_EQ(found.recording, odd);
    EXPECT_EQ(found.parameter, 0);
    const auto row = static_cast<Eigen::Index>(odd);
    const double difference = found.differences(row, 0), deviation = difference / found.sigmas(row, 0);
    EXPECT_NEAR(difference, 0.003 * kBase.left_radius, 4.0 * deviation);
    EXPECT_GT(found.between(0), 0.0);
  }
}

TEST(Homogeneity, of_two_that_differ_alike_names_the_same_in_any_order) {
  const vehicle::DriveModel model = lively_model();
  auto data = recordings(model, {kBase.left_radius, 1.003 * kBase.left_radius}, kSeed + 200);
  EXPECT_EQ(compared(data).recording, 1U);
  std::swap(data[0], data[1]);
  EXPECT_EQ(compared(data).recording, 1U) << "names are given anew: the later in the alphabet";
}

TEST(Homogeneity, is_not_asked_of_one_recording) {
  const vehicle::DriveModel model = lively_model();
  const auto data = recordings(model, {kBase.left_radius}, kSeed);
  auto fit = estimation::fit_joint(data, {}, vehicle::to_vector(kBase));
  const FitTask task{data, std::vector<bool>(vehicle::kBaseCount, false)};
  EXPECT_FALSE(homogeneity(task, {{}, std::move(fit).value()}, 0.0, {"drive"}));
}

}  // namespace
}  // namespace odomcalib::calib::report::homogeneity_test
