#include "calib/estimation/gyro_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "calib/vehicle/step_context.hpp"
#include "tests/unit/calib/estimation/driven_wheels.hpp"

namespace odomcalib::calib::estimation::gyro_fit_test {
namespace {

constexpr double kDegree = math::kPi / 180.0;
constexpr double kNoise = 0.1 * kDegree;  ///< rad/s, of a sample of the gyro
constexpr double kRate = 0.01;            ///< s between its samples
constexpr double kStep = 0.5;             ///< s, of a pair
constexpr double kLidar = 3e-4;           ///< m, rad
constexpr double kSlip = 4e-3;            ///< rad in each of them

struct GyroOptions {
  double scale = 1.02, bias = 0.01, offset = 0.0, noise = kNoise;
};

/// A drive whose wheels slip a little all the time. Where there is little to see, the lidar tells one motion
/// in `every`; the gyro never stops.
struct Drive {
  Drive(unsigned seed, std::size_t every, const GyroOptions& gyro = {})
      : model(drive(200.0), vehicle::make_context(drive(200.0), kNominal)), engine(seed) {
    const Eigen::VectorXd truth = vehicle::to_vector(kTruth);
    std::vector<vehicle::Interval> steps;
    for (double t = 1.0; t < 198.0; t += kStep) steps.push_back({t, t + kStep});
    const auto motions = model.predict(vehicle::as_span(truth), {}, steps);
    for (std::size_t k = 0; k < motions.size(); ++k) slips.push_back(kSlip * gauss(engine));
    recordings.resize(1);
    data.push_back({&model, {}});
    for (std::size_t k = 0; k < steps.size(); k += every)
      data[0].pairs.push_back(pair(steps[k], motions[k], slips[k]));
    read(gyro);
    fit.parameters = vehicle::to_vector(kNominal);
    auto fitted = fit_joint(data, {}, fit.parameters);
    EXPECT_TRUE(fitted.ok()) << fitted.error().text();
    fit = std::move(fitted).value();
  }
  measurement::SensorPair pair(const vehicle::Interval& interval, math::Pose motion, double slip) {
    measurement::SensorPair made;
    made.interval = interval;
    motion.x += kLidar * gauss(engine);
    motion.y += kLidar * gauss(engine);
    motion.yaw += slip + kLidar * gauss(engine);
    made.motion = motion;
    made.covariance = kLidar * kLidar * Eigen::Matrix3d::Identity();
    return made;
  }
  /// Adds the gyro readings of the robot that turned with its slip.
  void read(const GyroOptions& gyro) {
    const auto turning = model.trajectory(vehicle::as_span(vehicle::to_vector(kTruth)), {});
    for (double t = 0.5; t < 199.5; t += kRate) {
      const double at = t - gyro.offset;
      const double wheels = (turning.at(at + 5e-3).yaw - turning.at(at - 5e-3).yaw) / 1e-2;
      const auto step = static_cast<std::size_t>(std::max(0.0, (at - 1.0) / kStep));
      const double slip = at < 1.0 || step >= slips.size() ? 0.0 : slips[step] / kStep;
      const double turn = math::wrap_angle(1e-2 * wheels) / 1e-2 + slip;
      recordings[0].gyro.push_back({t, gyro.scale * turn + gyro.bias + gyro.noise * gauss(engine)});
    }
  }
  [[nodiscard]] GyroFit weigh() const { return fit_gyros(data, {}, fit, recordings); }

  vehicle::DriveModel model;
  std::mt19937 engine;
  std::normal_distribution<double> gauss;
  std::vector<double> slips;
  std::vector<measurement::FitData> data;
  std::vector<Recording> recordings;
  FitResult fit;
};

double deviation(const Eigen::MatrixXd& covariance) {
  return std::sqrt(covariance(vehicle::kTrackWidth, vehicle::kTrackWidth));
}

TEST(GyroFit, S2_40_where_the_lidar_sees_little_the_track_width_is_known_better) {
  const Drive drive(1, 8);
  const GyroFit witness = drive.weigh();
  ASSERT_FALSE(witness.gyros[0].fault) << *witness.gyros[0].fault;
  std::printf("track +- %.6f without, %.6f with a gyro; scale %.4f +- %.4f, bias %.5f, offset %.4f\n",
              deviation(drive.fit.covariance), deviation(witness.covariance), witness.gyros[0].scale,
              witness.gyros[0].scale_std, witness.gyros[0].bias, witness.gyros[0].offset);
  EXPECT_LT(deviation(witness.covariance), 0.8 * deviation(drive.fit.covariance));
  EXPECT_NEAR(witness.gyros[0].scale, 1.02, 4.0 * witness.gyros[0].scale_std);
  EXPECT_NEAR(witness.gyros[0].bias, 0.01, 1e-3);
}

TEST(GyroFit, S2_40_its_deviation_is_that_of_its_errors) {
  constexpr unsigned kRuns = 60;
  double before = 0.0, after = 0.0, stated = 0.0;
  for (unsigned run = 0; run < kRuns; ++run) {
    const Drive drive(100 + run, 8);
    const GyroFit witness = drive.weigh();
    ASSERT_FALSE(witness.gyros[0].fault) << *witness.gyros[0].fault;
    before += std::pow(drive.fit.parameters(vehicle::kTrackWidth) - kTruth.track_width, 2);
    after += std::pow(witness.parameters(vehicle::kTrackWidth) - kTruth.track_width, 2);
    stated += witness.covariance(vehicle::kTrackWidth, vehicle::kTrackWidth);
  }
  std::printf("track: errors %.6f without, %.6f with, stated %.6f\n", std::sqrt(before / kRuns),
              std::sqrt(after / kRuns), std::sqrt(stated / kRuns));
  EXPECT_LT(after, 0.8 * before);
  EXPECT_GT(std::sqrt(stated / after), 0.75);
  EXPECT_LT(std::sqrt(stated / after), 1.5);
}

TEST(GyroFit, S2_40_the_clock_of_its_own_is_found) {
  for (const double offset : {-0.23, 0.0, 0.107}) {
    const GyroFit witness = Drive(2, 1, {1.0, 0.0, offset, kNoise}).weigh();
    ASSERT_FALSE(witness.gyros[0].fault) << *witness.gyros[0].fault;
    EXPECT_NEAR(witness.gyros[0].offset, offset, 5e-3);
  }
}

struct Faulty {
  const char* name;
  GyroOptions gyro;
  const char* says;
};

class FaultyGyro : public ::testing::TestWithParam<Faulty> {};

TEST_P(FaultyGyro, S2_40_is_named_and_changes_nothing) {
  const Drive drive(3, 4, GetParam().gyro);
  const GyroFit witness = drive.weigh();
  ASSERT_TRUE(witness.gyros[0].fault);
  EXPECT_NE(witness.gyros[0].fault->find(GetParam().says), std::string::npos) << *witness.gyros[0].fault;
  EXPECT_EQ(witness.parameters, drive.fit.parameters);
  EXPECT_EQ(witness.covariance, drive.fit.covariance);
}

INSTANTIATE_TEST_SUITE_P(
    Gyros, FaultyGyro,
    ::testing::Values(Faulty{"reversed", {-1.02, 0.01, 0.0, kNoise}, "sign is reversed"},
                      Faulty{"degrees", {1.02 / kDegree, 0.5, 0.0, kNoise / kDegree}, "degrees per second"},
                      Faulty{
                          "reversed_degrees", {-1.0 / kDegree, 0.5, 0.0, kNoise / kDegree}, "reversed, and"},
                      Faulty{"twice", {kDegree, 0.0, 0.0, kNoise* kDegree}, "converted from degrees twice"},
                      Faulty{"range", {0.8, 0.0, 0.0, kNoise}, "20 % less"},
                      Faulty{"another_axis", {0.0, 0.01, 0.0, 0.05}, "does not follow"}),
    [](const auto& test) { return test.param.name; });

TEST(GyroFit, one_within_the_tolerance_of_gyros_is_no_fault) {
  for (const double scale : {0.93, 1.07})
    EXPECT_FALSE(Drive(4, 4, {scale, 0.0, 0.0, kNoise}).weigh().gyros[0].fault);
}

/// Intervals that a gyro was held against which read during so many of them, from this one on.
std::size_t used_during(std::size_t first, std::size_t count) {
  Drive drive(6, 1);
  const double begin = 1.0 + kStep * static_cast<double>(first),
               end = begin + kStep * static_cast<double>(count);
  std::erase_if(drive.recordings[0].gyro,
                [&](const GyroSample& sample) { return sample.t < begin - 0.1 || sample.t > end + 0.1; });
  return drive.weigh().gyros[0].used;
}

// The turns of the drive, both ways together, from its wheels: 7.57 rad in 19 intervals from the 208th
// on, 3.31 and 3.03 rad in 20 from the 14th and the 17th.
TEST(GyroFit, takes_20_intervals_and_half_a_turn) {
  EXPECT_EQ(used_during(208, 19), 0U);
  EXPECT_EQ(used_during(208, 20), 20U);
  EXPECT_EQ(used_during(14, 20), 20U);
  EXPECT_EQ(used_during(17, 20), 0U);
}

TEST(GyroFit, without_one_or_with_few_samples_the_fit_stands) {
  Drive drive(5, 4);
  drive.recordings[0].gyro.resize(100);
  for (int k = 0; k < 2; ++k) {
    const GyroFit witness = drive.weigh();
    EXPECT_EQ(witness.gyros[0].used, 0U);
    EXPECT_EQ(witness.parameters, drive.fit.parameters);
    EXPECT_EQ(witness.covariance, drive.fit.covariance);
    drive.recordings[0].gyro.clear();
  }
}

}  // namespace
}  // namespace odomcalib::calib::estimation::gyro_fit_test
