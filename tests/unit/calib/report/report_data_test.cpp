#include "calib/report/report_data.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "calib/report/contact_noise.hpp"
#include "calib/report/report.hpp"
#include "calib/report/residual_trace.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/validation/drive_error.hpp"
#include "calib/validation/settings.hpp"
#include "calib/vehicle/step_context.hpp"
#include "tests/unit/calib/driven_fit.hpp"

namespace odomcalib::calib::report::report_data_test {
namespace {

constexpr double kTick = 0.02;  // s
constexpr double kPair = 0.7;   // s
constexpr double kPositionNoise = 2e-4;
constexpr double kYawNoise = 2e-4;

const wheels::BaseParameters kNominal{0.075, 0.075, 0.40, {0.1, 0.0, 0.0}};
const wheels::BaseParameters kTruth{0.0765, 0.0760, 0.39, {0.09, 0.01, 0.02}};

/// Wheel angles of straights, spins and arcs, each forth and back, at two paces, from rest to rest.
wheels::WheelTrack drive(double duration) {
  constexpr std::array<std::array<double, 2>, 6> kMoves{
      {{2.7, 2.7}, {-2.7, -2.7}, {-1.6, 1.6}, {1.6, -1.6}, {1.0, 2.6}, {-1.0, -2.6}}};
  wheels::WheelTrack track;
  double left = 0.0;
  double right = 0.0;
  for (int k = 0; k * kTick < duration; ++k) {
    const double t = k * kTick;
    track.t.push_back(t);
    track.left.push_back(left);
    track.right.push_back(right);
    track.segment.push_back(0);
    const double phase = std::fmod(t, 9.0);
    const auto move = static_cast<std::size_t>(t / 9.0);
    const double pace = (move / kMoves.size()) % 2 == 0 ? 1.0 : 0.4;
    const double ramp = std::clamp(std::min(phase, 8.4 - phase), 0.0, 1.0) * pace;
    left += kTick * ramp * kMoves.at(move % kMoves.size())[0];
    right += kTick * ramp * kMoves.at(move % kMoves.size())[1];
  }
  return track;
}

struct World {
  vehicle::DriveModel model;
  std::vector<measurement::FitData> data;
};

/// Measurements of a sensor with white noise of its scans when the robot moves as `truth` and `effects` say.
std::unique_ptr<World> make_world(const vehicle::EffectList& effects, const std::vector<double>& values,
                                  unsigned seed) {
  const wheels::WheelTrack track = drive(420.0);
  auto world =
      std::make_unique<World>(World{vehicle::DriveModel(track, vehicle::make_context(track, kNominal)), {}});
  Eigen::VectorXd truth = vehicle::to_vector(kTruth, vehicle::count_parameters(effects));
  for (std::size_t k = 0; k < values.size(); ++k)
    truth(vehicle::kBaseCount + static_cast<Eigen::Index>(k)) = values[k];
  std::vector<vehicle::Interval> intervals;
  for (double t = 0.0; t + kPair < 419.0; t += kPair) intervals.push_back({t, t + kPair});
  const auto motions =
      world->model.predict({truth.data(), static_cast<std::size_t>(truth.size())}, effects, intervals);
  std::mt19937 engine(seed);
  std::normal_distribution<double> gauss;
  measurement::FitData data{&world->model, {}};
  for (std::size_t k = 0; k < motions.size(); ++k) {
    measurement::SensorPair pair{intervals[k], motions[k], Eigen::Matrix3d::Zero(), k > 0};
    pair.motion.x += kPositionNoise * gauss(engine);
    pair.motion.y += kPositionNoise * gauss(engine);
    pair.motion.yaw += kYawNoise * gauss(engine);
    pair.covariance.diagonal() << kPositionNoise * kPositionNoise, kPositionNoise * kPositionNoise,
        kYawNoise * kYawNoise;
    data.pairs.push_back(pair);
  }
  world->data.push_back(data);
  return world;
}

estimation::FitResult fitted(const World& world, const vehicle::EffectList& effects) {
  auto fit = estimation::fit_joint(world.data, effects,
                                   vehicle::to_vector(kNominal, vehicle::count_parameters(effects)));
  EXPECT_TRUE(fit.ok()) << (fit.ok() ? "" : fit.error().text());
  return std::move(fit).value();
}

std::vector<bool> none_fixed(const vehicle::EffectList& effects) {
  return std::vector<bool>(vehicle::kBaseCount + vehicle::count_parameters(effects), false);
}

DriveError named(const std::vector<DriveError>& errors, const std::string& name) {
  for (const auto& error : errors)
    if (error.name == name) return error;
  ADD_FAILURE() << name << " is missing";
  return {};
}

TEST(DriveErrors, before_is_what_the_wrong_dimensions_do_and_after_is_noise) {
  const unsigned seed = 11;
  const auto world = make_world({}, {}, seed);
  const estimation::FitResult fit = fitted(*world, {});
  const auto errors = validation::drive_errors(world->data, kNominal, nullptr, {&fit, none_fixed({}), {}});

  const double mean = 0.5 * (kTruth.left_radius + kTruth.right_radius);
  const DriveError metre = named(errors, "straight_metre_length");
  ASSERT_TRUE(metre.before && metre.after && metre.noise_floor);
  EXPECT_NEAR(metre.before->value, 1.0 - kNominal.left_radius / mean, 2e-4);
  EXPECT_FALSE(metre.geometry.has_value());

  // A full turn of the robot is 2 pi b / (r phi) with true values; the nominal ones read another angle for
  // it.
  const double read = kNominal.left_radius / mean * kTruth.track_width / kNominal.track_width;
  const DriveError turn = named(errors, "full_turn_heading");
  ASSERT_TRUE(turn.before && turn.after && turn.noise_floor);
  EXPECT_NEAR(turn.before->value, 2.0 * M_PI * std::abs(read - 1.0), 2e-3);

  for (const DriveError& error : errors) {
    ASSERT_TRUE(error.before && error.after && error.noise_floor) << error.name;
    EXPECT_LT(error.after->value, 0.2 * error.before->value) << error.name;
    EXPECT_GT(error.after->value, 0.6 * *error.noise_floor) << error.name << " seed " << seed;
    EXPECT_LT(error.after->value, 1.5 * *error.noise_floor) << error.name << " seed " << seed;
    EXPECT_LE(error.after->low, error.after->value);
    EXPECT_GE(error.after->high, error.after->value);
    EXPECT_GE(error.stretches, 4U);
  }
}

/// m of way, RMS position errors at it.
double error_at(const std::vector<ErrorGrowth>& growth, double way, std::optional<double> ErrorGrowth::*of) {
  for (const ErrorGrowth& one : growth)
    if (std::abs(one.way - way) < 0.15 * way && one.*of) return *(one.*of);
  ADD_FAILURE() << "nothing at " << way << " m";
  return 0.0;
}

TEST(ErrorGrowth, grows_with_the_way_before_and_stays_small_after) {
  const auto world = make_world({}, {}, 11);
  const estimation::FitResult fit = fitted(*world, {});
  const auto growth = validation::error_growth(world->data, kNominal, nullptr, {&fit, none_fixed({}), {}});
  ASSERT_GE(growth.size(), 4U);
  for (std::size_t k = 0; k < growth.size(); ++k) {
    EXPECT_GE(growth[k].stretches, 4U);
    EXPECT_FALSE(growth[k].geometry.has_value());
    ASSERT_TRUE(growth[k].before && growth[k].after);
    EXPECT_LT(*growth[k].after, 0.3 * *growth[k].before) << growth[k].way;
    EXPECT_GT(growth[k].way, k > 0 ? growth[k - 1].way : 0.0);
  }
  EXPECT_GT(error_at(growth, 2.0, &ErrorGrowth::before), 1.5 * error_at(growth, 0.5, &ErrorGrowth::before));
  for (const auto& one : validation::error_growth(world->data, {}, nullptr, {&fit, none_fixed({}), {}}))
    EXPECT_FALSE(one.before.has_value()) << "no nominal values";
}

TEST(DriveErrors, unknown_nominal_values_give_no_before) {
  const auto world = make_world({}, {}, 12);
  const estimation::FitResult fit = fitted(*world, {});
  for (const auto& error :
       validation::drive_errors(world->data, {0.0, 0.0, 0.0, {}}, nullptr, {&fit, none_fixed({}), {}}))
    EXPECT_FALSE(error.before.has_value()) << error.name;
}

/// In one pair in twelve the robot is pushed by 30 mm, which the matches see and the wheels do not.
std::unique_ptr<World> pushed_world() {
  auto world = make_world({}, {}, 13);
  measurement::FitData& data = world->data.front();
  for (std::size_t k = 5; k < data.pairs.size(); k += 12) data.pairs[k].motion.x += 0.03;
  return world;
}

/// Places of all scans between which a world's pairs lie.
std::vector<measurement::PlacedScan> places_along(const std::vector<measurement::SensorPair>& pairs) {
  std::vector<measurement::PlacedScan> places;
  math::Pose here;
  for (const measurement::SensorPair& pair : pairs) {
    for (const double before : {1e-4, 0.0, -1e-4})
      places.push_back({pair.interval.begin - before, here, 1e-8 * Eigen::Matrix3d::Identity()});
    here = compose(here, pair.motion);
  }
  return places;
}

TEST(DriveErrors, what_a_fit_leaves_out_counts_where_a_map_confirms_it) {
  const auto world = pushed_world();
  const estimation::FitResult fit = fitted(*world, {});
  ASSERT_GT(fit.discarded, 40U) << "seed 13";
  const auto over_ten_seconds = [&] {
    return named(validation::drive_errors(world->data, kNominal, nullptr, {&fit, none_fixed({}), {}}),
                 "open_loop_10s_position");
  };
  const auto without = validation::drive_errors(world->data, kNominal, nullptr, {&fit, none_fixed({}), {}});
  EXPECT_FALSE(std::any_of(without.begin(), without.end(), [](const DriveError& error) {
    return error.name == "open_loop_10s_position" && error.after->value > 0.01;
  }));
  world->data.front().places = places_along(world->data.front().pairs);
  EXPECT_GT(over_ten_seconds().after->value, 0.025);
}

TEST(DriveErrors, are_no_smaller_when_held_against_places) {
  const auto world = make_world({}, {}, 11);
  const estimation::FitResult fit = fitted(*world, {});
  const auto metre = [&] {
    return named(validation::drive_errors(world->data, kNominal, nullptr, {&fit, none_fixed({}), {}}),
                 "straight_metre_length");
  };
  const DriveError by_matches = metre();
  world->data.front().places = places_along(world->data.front().pairs);
  const DriveError by_places = metre();
  EXPECT_EQ(by_places.stretches, by_matches.stretches);
  EXPECT_NEAR(by_places.before->value, by_matches.before->value, 0.02 * by_matches.before->value);
}

/// Where a sensor that moves as `truth` says is ten times a second.
std::vector<measurement::PlacedScan> places_of(const vehicle::DriveModel& model,
                                               const wheels::BaseParameters& truth) {
  const Eigen::VectorXd parameters = vehicle::to_vector(truth);
  const vehicle::Trajectory trajectory = model.trajectory(vehicle::as_span(parameters), {});
  std::vector<measurement::PlacedScan> places;
  for (double t = 0.0; t < 419.0; t += 0.1)
    places.push_back({t, compose(trajectory.at(t), truth.mount), 1e-8 * Eigen::Matrix3d::Identity()});
  return places;
}

// Stretches begin and end with a ramp, so that scans on one side of an end were taken at rest.
TEST(DriveErrors, are_measured_by_a_reference_that_leans_to_no_wheels_that_are_judged) {
  const auto world = make_world({}, {}, 11);
  const estimation::FitResult fit = fitted(*world, {});
  world->data.front().places = places_of(world->model, kTruth);
  const auto errors = validation::drive_errors(world->data, kNominal, nullptr, {&fit, none_fixed({}), {}});

  const double length = kNominal.left_radius / (0.5 * (kTruth.left_radius + kTruth.right_radius));
  const double metre = 1.0 - length;
  EXPECT_NEAR(named(errors, "straight_metre_length").before->value, metre, 0.003 * metre);
  const double turn = 2.0 * M_PI * std::abs(length * kTruth.track_width / kNominal.track_width - 1.0);
  EXPECT_NEAR(named(errors, "full_turn_heading").before->value, turn, 0.001 * turn);
}

TEST(DriveErrors, too_short_a_recording_gives_no_figures) {
  const auto world = make_world({}, {}, 13);
  const estimation::FitResult fit = fitted(*world, {});
  world->data.front().pairs.resize(5);
  estimation::FitResult cut = fit;
  cut.weights.resize(5);
  cut.whitened_residual = fit.whitened_residual.head(15).eval();
  cut.whitened_jacobian = fit.whitened_jacobian.topRows(15).eval();
  EXPECT_TRUE(validation::drive_errors(world->data, kNominal, nullptr, {&cut, none_fixed({}), {}}).empty());
}

/// With an effect the geometry alone is worse than everything that was found.
TEST(DriveErrors, effects_show_between_geometry_and_after) {
  const vehicle::EffectList effects = {terms::find_effect("backlash")};
  const auto world = make_world(effects, {0.06, 0.06}, 14);
  const estimation::FitResult full = fitted(*world, effects);
  const estimation::FitResult plain = fitted(*world, {});
  const validation::JudgedModel geometry{&plain, none_fixed({}), {}};
  const auto errors = drive_errors(world->data, kNominal, &geometry, {&full, none_fixed(effects), effects});
  const DriveError turn = named(errors, "open_loop_10s_heading");
  ASSERT_TRUE(turn.geometry && turn.after && turn.before);
  EXPECT_GT(turn.geometry->low, 2.0 * turn.after->high);
  EXPECT_GT(turn.before->value, turn.geometry->value);
}

double systematic(const ResidualTrace& trace, double ResidualTrace::Bin::*member) {
  double sum = 0.0;
  for (const auto& bin : trace.bins) sum += bin.*member * bin.*member;
  return std::sqrt(sum / static_cast<double>(trace.bins.size()));
}

struct Expected {
  const char* effect;
  std::vector<double> values;
  const char* variable;  ///< part of its name
  double explained;      ///< least share of the pattern; play is taken up over two measured motions
};

class Traces : public ::testing::TestWithParam<Expected> {};

TEST_P(Traces, show_the_variable_that_the_effect_acts_by_and_that_it_is_gone) {
  const Expected& expected = GetParam();
  const vehicle::EffectList effects = {terms::find_effect(expected.effect)};
  ASSERT_NE(effects.front(), nullptr);
  const auto world = make_world(effects, expected.values, 15);
  const auto traces =
      report::residual_traces(world->data, effects, fitted(*world, effects), none_fixed(effects));
  ASSERT_EQ(traces.size(), 1U);
  EXPECT_THAT(traces[0].variable, ::testing::HasSubstr(expected.variable));
  EXPECT_GT(traces[0].explained, expected.explained);
  EXPECT_GT(systematic(traces[0], &ResidualTrace::Bin::before),
            3.0 * systematic(traces[0], &ResidualTrace::Bin::after));
  EXPECT_LE(traces[0].points.size(), 300U);
  EXPECT_GE(traces[0].points.size(), 100U);
}

INSTANTIATE_TEST_SUITE_P(effects, Traces,
                         ::testing::Values(Expected{"backlash", {0.06, 0.06}, "reversals", 0.2},
                                           Expected{
                                               "wheel_eccentricity", {0.01, 0.005}, "left wheel angle", 0.5},
                                           Expected{"time_offset", {0.03}, "acceleration", 0.5}),
                         [](const auto& test) { return std::string(test.param.effect); });

TEST(Trace, is_not_shown_of_an_effect_that_is_too_small_to_be_told) {
  const vehicle::EffectList effects = {terms::find_effect("time_offset"), terms::find_effect("scan_skew")};
  const auto world = make_world(effects, {0.03, 0.0, 0.0}, 15);
  const auto traces = report::residual_traces(world->data, effects, fitted(*world, effects),
                                              none_fixed(effects), {effects.front()});
  ASSERT_EQ(traces.size(), 1U);
  EXPECT_EQ(traces.front().effect, "scan_skew");
}

/// A drive whose wheels slip at random, by so much a sample, m.
Recording slipping_recording(double slip) {
  Recording recording = test_support::driven_recording({});
  std::mt19937 random(test_support::kDriveSeed);
  std::normal_distribution<double> error(0.0, slip / test_support::kLeftRadius / (2.0 * math::kPi) * 65536.0);
  double left = 0.0, right = 0.0;
  for (TickSample& tick : recording.ticks) {
    tick.left += std::llround(left += error(random));
    tick.right += std::llround(right += error(random));
  }
  return recording;
}

ReportData report_of(const Recording& recording) {
  estimation::Fit fit = test_support::settled_fit({&recording, 1});
  EXPECT_FALSE(fit.failure);
  selection::SearchResult found;
  found.model = {fit.model.effects, fit.result};
  return make_report_data(fit.dataset, found, std::nullopt);
}

// Poses err by 0.5 mm and 0.5 mrad. What a pair is weighed with holds both errors, so that a reference worse
// than the wheels weighs less than they do.
TEST(ReportData, S1_09_states_the_error_of_the_reference_beside_that_of_the_wheels) {
  const ReportData good = report_of(slipping_recording(0.0)), bad = report_of(slipping_recording(1e-3));
  ASSERT_EQ(good.axes.size(), 3U);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_LT(good.axes[axis].wheels_std, good.axes[axis].reference_std) << good.axes[axis].name;
    EXPECT_GT(bad.axes[axis].wheels_std, 2.0 * good.axes[axis].wheels_std) << bad.axes[axis].name;
  }
  EXPECT_GT(bad.axes[2].wheels_std, bad.axes[2].reference_std);
}

TEST(SamplePairs, S0_08_hold_both_motions_of_the_base_over_the_same_time) {
  const Recording recording = test_support::driven_recording({});
  const estimation::Fit fit = test_support::settled_fit({&recording, 1});
  ASSERT_FALSE(fit.failure);
  const auto samples = sample_pairs(fit.dataset, fit.model.effects, fit.result);
  ASSERT_EQ(samples.size(), fit.dataset.data.front().pairs.size());
  double end = 0.0;
  for (const measurement::SamplePair& sample : samples) {
    EXPECT_EQ(sample.recording, 0U);
    EXPECT_GE(sample.begin, end - 1e-9);
    EXPECT_GT(sample.end, sample.begin);
    end = sample.end;
    // Nominal wheels are off by a per cent, the track width by 2.5; a pair is half a metre or half a radian.
    EXPECT_NEAR(sample.odometry[0], sample.reference[0], 0.02);
    EXPECT_NEAR(sample.odometry[1], sample.reference[1], 0.02);
    EXPECT_NEAR(sample.odometry[2], sample.reference[2], 0.05);
  }
}

// Where the reference was away, odometry goes on from where it was last seen.
TEST(ReportData, path_of_the_reference_goes_over_its_gaps) {
  Recording recording = test_support::driven_recording({});
  const double first = test_support::rough_dataset({&recording, 1}).data.front().pairs.front().interval.end;
  std::erase_if(recording.poses, [&](const PoseSample& pose) {
    return (pose.t > first + 0.01 && pose.t < first + 12.0) || (pose.t > 60.0 && pose.t < 72.0);
  });
  const measurement::Dataset dataset = test_support::rough_dataset({&recording, 1});
  ASSERT_FALSE(dataset.data.front().pairs.at(1).follows_previous) << "the first gap is behind the first pair";
  const ReportData data = report_of(recording);
  ASSERT_EQ(data.paths.size(), 3U);
  for (const double without_a_part : data.left_out.at(0).second)
    EXPECT_NEAR(without_a_part, 2.0 * test_support::kLeftRadius, 5e-4);
  for (const double without_a_part : data.left_out.at(1).second)
    EXPECT_NEAR(without_a_part, 2.0 * test_support::kRightRadius, 5e-4);
  const auto &calibrated = data.paths[1].points.back(), &reference = data.paths[2].points.back();
  EXPECT_LT(std::hypot(calibrated[0] - reference[0], calibrated[1] - reference[1]), 0.25);
}

TEST(ReportData, counts_what_is_trusted_just_enough) {
  const Recording recording = test_support::driven_recording({});
  const estimation::Fit fit = test_support::settled_fit({&recording, 1});
  ASSERT_FALSE(fit.failure);
  selection::SearchResult found;
  found.model = {fit.model.effects, fit.result};
  const auto std_with = [&](double weight) {
    for (std::size_t k = 0; k < 10; ++k) {
      found.model.fit.weights[k] = weight;
      found.model.fit.residuals(static_cast<Eigen::Index>(k), 0) = 1.0;
    }
    const ReportData data = make_report_data(fit.dataset, found, std::nullopt);
    EXPECT_EQ(data.series.size(), fit.dataset.data.front().pairs.size())
        << "few enough to be shown one by one";
    return data.axes[0].std;
  };
  EXPECT_GT(std_with(1.01 * validation::settings::kTrustedWeight), 0.1);
  EXPECT_LT(std_with(0.99 * validation::settings::kTrustedWeight), 0.01);
}

TEST(ClassicalMethods, S3_11_rounds_and_shares_of_the_closed_form_are_those_asked_for) {
  const Recording recording = test_support::driven_recording({});
  const measurement::Dataset dataset = test_support::rough_dataset({&recording, 1});
  const auto discarded = [&](const classical::ClosedFormOptions& cuts) {
    Calibration calibration;
    return classical_methods(dataset, 0.0, cuts, calibration).back().discarded;
  };
  EXPECT_EQ(discarded({0, 0.01}), 0U);
  const std::size_t pairs = dataset.data.front().pairs.size();
  EXPECT_GE(discarded({1, 0.2}), pairs / 4) << "two cuts of a fifth, by position and by heading";
  EXPECT_GT(discarded({3, 0.2}), discarded({1, 0.2}));
}

TEST(ClassicalMethods, each_has_its_name_also_where_it_is_refused) {
  const Recording recording = test_support::driven_recording({}, 0.0);
  const measurement::Dataset dataset = test_support::rough_dataset({&recording, 1});
  Calibration calibration;
  std::vector<std::string> names;
  std::size_t refused = 0;
  for (const MethodResult& method : classical_methods(dataset, 0.0, {0, 0.01}, calibration)) {
    names.push_back(method.name);
    refused += method.refused ? 1 : 0;
  }
  EXPECT_EQ(names, (std::vector<std::string>{"straight", "spin", "linear", "joint_closed_form"}));
  EXPECT_GE(refused, 1U) << "nothing turned on the spot";
}

TEST(ClassicalMethods, of_true_values_the_linear_correction_is_none) {
  const Recording recording = test_support::driven_recording({});
  measurement::Dataset dataset = test_support::rough_dataset({&recording, 1});
  dataset.nominal.left_radius = test_support::kLeftRadius;
  dataset.nominal.right_radius = test_support::kRightRadius;
  dataset.nominal.track_width = test_support::kTrackWidth;
  Calibration calibration;
  classical_methods(dataset, 0.0, {0, 0.01}, calibration);
  ASSERT_TRUE(calibration.linear_correction);
  for (std::size_t row : {0U, 2U})
    for (std::size_t column : {0U, 2U})
      EXPECT_NEAR(calibration.linear_correction->matrix[row][column], row == column ? 1.0 : 0.0, 0.01)
          << row << column;
}

TEST(BaseQuantities, what_stays_as_it_is_has_no_deviation) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(6, 6);
  covariance(1, 1) = 1e-8;
  const QuantityList list = base_quantities(kTruth, covariance);
  ASSERT_EQ(list.size(), 6U);
  for (std::size_t k = 0; k < list.size(); ++k)
    EXPECT_NEAR(list[k].second.std, k == 1 ? 2e-4 : -1.0, 1e-12) << list[k].first;
}

ReportData example() {
  ReportData data;
  data.drive_errors = {{"straight_metre_length", "m", 9, Bounded{0.02, 0.01, 0.03}, std::nullopt,
                        Bounded{0.001, 0.0005, 0.002}, 0.0008}};
  data.traces = {{"backlash", "speed", "m/s", "heading", "rad", 0.8, {{0.1, 0.2, 0.3}}, {{1, 2, 3, 4, 5}}}};
  data.paths = {{"odometry", {{0.0, 0.0, 0.0}, {1.0, -2.5, 0.5}}}};
  data.axes = {{"x", "m", 1e-4, 2e-3, 1.1, 0.2, -1.5, {1, 2, 3}, 3e-4, 4e-4}};
  data.series = {{1.5, {0.1, -0.2, 3.0}}};
  data.left_out = {{"track_width", {0.4, 0.41}}};
  return data;
}

TEST(ReportData, survives_the_calibration_file) {
  Calibration calibration;
  store_report_data(example(), calibration);
  const auto read = calibration_from_json(to_json(calibration), "test");
  ASSERT_TRUE(read.ok()) << read.error().text();
  const ReportData data = report_data_of(read.value());
  ASSERT_EQ(data.drive_errors.size(), 1U);
  EXPECT_DOUBLE_EQ(data.drive_errors[0].before->high, 0.03);
  EXPECT_FALSE(data.drive_errors[0].geometry.has_value());
  EXPECT_DOUBLE_EQ(*data.drive_errors[0].noise_floor, 0.0008);
  ASSERT_EQ(data.traces.size(), 1U);
  EXPECT_DOUBLE_EQ(data.traces[0].points.at(0).after, 0.3);
  EXPECT_DOUBLE_EQ(data.traces[0].bins.at(0).after_error, 5.0);
  EXPECT_EQ(data.paths.at(0).points.at(1), (std::array{1.0, -2.5, 0.5}));
  EXPECT_EQ(data.axes.at(0).histogram, (std::vector<std::size_t>{1, 2, 3}));
  EXPECT_EQ(data.axes.at(0).reference_std, 3e-4);
  EXPECT_EQ(data.axes.at(0).wheels_std, 4e-4);
  EXPECT_EQ(data.series.at(0).sigmas[2], 3.0);
  EXPECT_EQ(data.left_out.at(0).second.size(), 2U);
}

TEST(ReportData, members_of_another_shape_are_as_good_as_absent) {
  for (const char* text :
       {"7", "[1,2]", "{}", "[{\"name\":3}]", "null", "{\"paths\":{\"a\":1}}", "no JSON"}) {
    Calibration calibration;
    store_report_data(example(), calibration);
    calibration.picture.reset();
    calibration.unknown[""]["picture"] = text;
    const auto read = calibration_from_json(to_json(calibration), "test");
    ASSERT_TRUE(read.ok()) << read.error().text();
    const ReportData data = report_data_of(read.value());
    EXPECT_EQ(data.drive_errors.size(), 1U) << text;
    EXPECT_TRUE(data.paths.empty() && data.traces.empty() && data.axes.empty() && data.series.empty())
        << text;
  }
}

}  // namespace
}  // namespace odomcalib::calib::report::report_data_test
