// The library as other programs use it: through its C interface, beside the code that the rest of the program
// runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <odomcalib/odometry.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>

#include "calib/odometry/correction.hpp"
#include "calib/odometry/predict.hpp"
#include "calib/odometry/uncertainty.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/fitted_smooth_term.hpp"
#include "calib/terms/lidar_effect.hpp"
#include "proto/calibration/calibration.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/calib/library/counted_memory.hpp"
#include "tests/unit/calib/shared_data.hpp"
#include "tests/unit/calib/some_drive.hpp"

namespace odomcalib::calib::library::library_test {
namespace {

using test_support::kRobot;
using test_support::some_drive;
using ::testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Close {
  void operator()(odomcalib_odometry* odometry) const { odomcalib_odometry_close(odometry); }
};
using Handle = std::unique_ptr<odomcalib_odometry, Close>;

struct Opened {
  int status;
  Handle handle;
  std::string problem;
};

Opened open(const std::string& text, const odomcalib_options* options = nullptr) {
  odomcalib_odometry* odometry = nullptr;
  std::array<char, 400> problem{};
  const int status = odomcalib_odometry_open_text(text.data(), text.size(), options, &odometry,
                                                  problem.data(), problem.size());
  return {status, Handle(odometry), problem.data()};
}

Calibration accepted() {
  Calibration calibration = odometry::nominal_calibration(kRobot);
  calibration.verdict = Verdict::accepted;
  calibration.parameters[0].second.value *= 1.004;
  calibration.parameters[2].second.value *= 0.991;
  return calibration;
}

EffectResult result_of(const vehicle::Effect& effect, double std = -1.0) {
  EffectResult result;
  result.name = effect.name();
  for (const vehicle::EffectParameter& p : effect.parameters())
    result.parameters.push_back(
        {p.name, {p.start + (p.fixed ? 0.0 : p.scale), p.fixed ? -1.0 : std, p.unit}});
  return result;
}

Calibration with_effect(const vehicle::Effect& effect) {
  Calibration calibration = accepted();
  calibration.effects = {result_of(effect, 1e-4)};
  return calibration;
}

/// Every effect of the catalogue, and curves.
Calibration with_all_effects() {
  Calibration calibration = accepted();
  for (const auto& effect : terms::effect_catalogue())
    calibration.effects.push_back(result_of(*effect, 1e-4));
  std::vector<terms::FittedSmoothTerm> smooths;
  for (const auto covariate : {vehicle::Covariate::speed, vehicle::Covariate::since_stop,
                               vehicle::Covariate::previous_acceleration, vehicle::Covariate::turn_rate}) {
    const terms::SmoothTerm smooth{{covariate, vehicle::Channel::both_travel}, -1.0, 1.0};
    smooths.push_back({smooth, std::vector<double>(function_count(smooth), 0.002), ""});
  }
  calibration.curves = terms::entries_of(smooths);
  return calibration;
}

std::array<double, 3> pose_of(const Handle& handle) {
  std::array<double, 3> pose{};
  EXPECT_EQ(odomcalib_odometry_pose(handle.get(), pose.data()), ODOMCALIB_OK);
  return pose;
}

int update(const Handle& handle, const TickSample& sample) {
  return odomcalib_odometry_update_counts(handle.get(), sample.t, sample.left, sample.right);
}

void expect_same(const std::array<double, 3>& pose, const PoseSample& expected, const std::string& where) {
  ASSERT_EQ(pose[0], expected.x) << where;
  ASSERT_EQ(pose[1], expected.y) << where;
  ASSERT_EQ(pose[2], expected.yaw) << where;
}

/// Expects the library's poses of a recording to be those of the program, to the last bit: sample by sample
/// those of the running daemon, at once those of predict.
void expect_equal(const Recording& recording, const Calibration& calibration, const std::string& what) {
  Calibration of_recording = calibration;
  of_recording.robot.ticks_per_rev = recording.robot.ticks_per_rev;
  const std::string text = to_json(of_recording);
  const Calibration read = calibration_from_json(text, "test").value();
  const auto opened = open(text);
  ASSERT_EQ(opened.status, ODOMCALIB_OK) << opened.problem;
  const auto live = odometry::predict_live(recording, read);
  for (std::size_t k = 0; k < recording.ticks.size(); ++k) {
    if (k > 0 && recording.ticks[k].segment != recording.ticks[k - 1].segment)
      odomcalib_odometry_restart(opened.handle.get());
    ASSERT_EQ(update(opened.handle, recording.ticks[k]), ODOMCALIB_OK)
        << what << odomcalib_odometry_problem(opened.handle.get());
    expect_same(pose_of(opened.handle), live[k], what + " sample " + std::to_string(k));
  }
  if (recording.ticks.back().segment > 0) return;
  std::vector<double> stamps, poses(3 * recording.ticks.size());
  std::vector<std::int64_t> left, right;
  for (const TickSample& sample : recording.ticks) {
    stamps.push_back(sample.t);
    left.push_back(sample.left);
    right.push_back(sample.right);
  }
  ASSERT_EQ(odomcalib_odometry_path(opened.handle.get(), stamps.size(), stamps.data(), left.data(),
                                    right.data(), poses.data()),
            ODOMCALIB_OK);
  const auto batch = odometry::predict(recording, read);
  for (std::size_t k = 0; k < batch.size(); ++k)
    expect_same({poses[3 * k], poses[3 * k + 1], poses[3 * k + 2]}, batch[k], what + " at once");
}

TEST(Library, poses_are_those_of_the_program_to_the_last_bit_with_every_effect) {
  expect_equal(some_drive(), accepted(), "no effect");
  for (const auto& effect : terms::effect_catalogue())
    expect_equal(some_drive(), with_effect(*effect), effect->name());
  expect_equal(some_drive(), with_all_effects(), "all effects");
}

TEST(Library, poses_are_those_of_the_program_to_the_last_bit_on_the_clock_of_the_calibration) {
  Calibration calibration = with_all_effects();
  calibration.data.resize(1);
  calibration.data[0].begin = -20.0;
  calibration.data[0].duration = 60.0;
  const terms::SmoothTerm steady{{vehicle::Covariate::time, vehicle::Channel::both_travel}, 0.0, 60.0};
  calibration.curves = terms::entries_of({{steady, std::vector<double>(function_count(steady), 0.01), ""}});
  expect_equal(some_drive(), calibration, "curve of time");
}

// Real recordings of several robots: jitter, pauses, resets and all.
TEST(Library, poses_are_those_of_the_program_to_the_last_bit_on_real_recordings) {
  ODOMCALIB_NEEDS_SHARED("maebot/empty.jsonl.gz");
  for (const char* name :
       {"maebot/empty.jsonl.gz", "maebot/convex.jsonl.gz", "maebot/a0.jsonl.gz",
        "brenner-nxt/robot4.jsonl.gz", "azos-wheelchair/azos.jsonl.gz", "mines-rover/exp1.jsonl.gz"}) {
    const auto read = read_recording(test_support::shared_data(name));
    if (!read.ok() || read.value().ticks.empty()) {
      ADD_FAILURE() << name << " was not read";
      continue;
    }
    expect_equal(read.value(), accepted(), name);
    expect_equal(read.value(), with_all_effects(), name);
  }
}

/// Real ones that tests/regression/compare solves.
std::vector<std::filesystem::path> all_real_recordings() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(test_support::shared_data(""))) {
    const std::string name = entry.path().filename().string();
    const bool is_recording = name.ends_with(".jsonl.gz") || name.ends_with(".lcmlog.gz");
    const bool is_part =
        std::regex_search(name, std::regex(R"(\.(scans|ticks|odom|slam|truth|landmarks)\.)")) ||
        entry.path().parent_path().filename() == "scanmatch";
    if (entry.is_regular_file() && is_recording && !is_part) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST(Library, poses_are_those_of_the_program_to_the_last_bit_on_every_real_recording) {
  ODOMCALIB_NEEDS_SHARED("maebot/empty.jsonl.gz");
  if (!test_support::long_tests()) GTEST_SKIP() << "takes minutes: ./test.sh --long";
  const RobotDescription robot{0.15, 0.15, 0.4, 4096.0, std::nullopt, "", ""};
  std::size_t count = 0;
  for (const std::filesystem::path& file : all_real_recordings()) {
    auto read = read_recording(file);
    if (!read.ok()) read = read_recording(file, &robot);
    if (!read.ok() || read.value().ticks.empty()) continue;
    ++count;
    expect_equal(read.value(), with_all_effects(), file.string());
  }
  std::cout << count << " recordings\n";
  EXPECT_GE(count, 30U);
}

TEST(Library, poses_are_those_of_the_program_to_the_last_bit_on_every_simulated_recording) {
  if (!test_support::long_tests()) GTEST_SKIP() << "takes minutes: ./test.sh --long";
  const TemporaryFolder folder;
  ASSERT_EQ(std::system((ODOMCALIB_REGRESSION " --simulate " ODOMCALIB_PROGRAMS " --work " +
                         folder.path().string() + " > " + (folder / "log").string())
                            .c_str()),
            0);
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    if (entry.path().extension() != ".gz") continue;
    ++count;
    expect_equal(read_recording(entry.path()).value(), with_all_effects(), entry.path().filename().string());
  }
  std::cout << count << " recordings\n";
  EXPECT_GE(count, 30U);
}

TEST(Library, updates_take_no_memory) {
  const Recording drive = some_drive();
  const auto opened = open(to_json(with_all_effects()));
  ASSERT_EQ(opened.status, ODOMCALIB_OK) << opened.problem;
  std::array<double, 9> covariance{};
  std::array<double, 3> three{};
  test_support::count_allocations();
  for (const TickSample& sample : drive.ticks) {
    update(opened.handle, sample);
    odomcalib_odometry_pose(opened.handle.get(), three.data());
    odomcalib_odometry_velocity(opened.handle.get(), three.data());
    odomcalib_odometry_covariance(opened.handle.get(), covariance.data());
    odomcalib_odometry_velocity_covariance(opened.handle.get(), covariance.data());
  }
  odomcalib_odometry_update_counts(opened.handle.get(), kNaN, 0, 0);
  odomcalib_odometry_update_counts(opened.handle.get(), 1e6, 1LL << 40, 0);
  odomcalib_odometry_update_counts(opened.handle.get(), 0.0, 0, 0);
  EXPECT_EQ(test_support::counted_allocations(), 0U);
  test_support::count_allocations();
  const auto other = open(to_json(with_all_effects()));
  EXPECT_GT(test_support::counted_allocations(), 100U) << "those of the library are counted";
}

/// Straight ahead, 100 counts every 20 ms.
TickSample ahead(int k) { return {0.02 * k, std::int64_t{100} * k, std::int64_t{100} * k, 0}; }

double x_after(const Handle& handle) { return pose_of(handle)[0]; }

TEST(Library, what_is_no_number_leaves_the_pose_and_the_next_sample_goes_on) {
  const auto opened = open(to_json(accepted()));
  for (int k = 0; k < 5; ++k) ASSERT_EQ(update(opened.handle, ahead(k)), ODOMCALIB_OK);
  const double x = x_after(opened.handle);
  EXPECT_EQ(odomcalib_odometry_update_counts(opened.handle.get(), kNaN, 500, 500), ODOMCALIB_NOT_A_NUMBER);
  EXPECT_THAT(odomcalib_odometry_problem(opened.handle.get()), HasSubstr("no finite number"));
  EXPECT_EQ(
      odomcalib_odometry_update_counts(opened.handle.get(), 0.1, std::numeric_limits<std::int64_t>::max(), 0),
      ODOMCALIB_NOT_A_NUMBER);
  EXPECT_EQ(x_after(opened.handle), x);
  EXPECT_EQ(update(opened.handle, ahead(5)), ODOMCALIB_OK);
  EXPECT_STREQ(odomcalib_odometry_problem(opened.handle.get()), "");
  EXPECT_NEAR(x_after(opened.handle), 1.25 * x, 1e-8) << "no motion is lost";
}

TEST(Library, a_count_that_was_read_wrong_once_loses_nothing_and_a_reset_no_pose) {
  const auto opened = open(to_json(accepted()));
  for (int k = 0; k < 5; ++k) ASSERT_EQ(update(opened.handle, ahead(k)), ODOMCALIB_OK);
  const double x = x_after(opened.handle);
  EXPECT_EQ(odomcalib_odometry_update_counts(opened.handle.get(), 0.1, 5'000'000, 500), ODOMCALIB_JUMP);
  EXPECT_THAT(odomcalib_odometry_problem(opened.handle.get()),
              HasSubstr("jump by 4999600 left and 100 right"));
  EXPECT_EQ(x_after(opened.handle), x);
  EXPECT_EQ(update(opened.handle, ahead(6)), ODOMCALIB_OK);
  EXPECT_NEAR(x_after(opened.handle), 1.5 * x, 1e-8);
  // Now the counter begins anew, far from where it was.
  const auto far = [](int k) { return TickSample{0.02 * k, 100 * k + 9'000'000, 100 * k + 9'000'000, 0}; };
  EXPECT_EQ(update(opened.handle, far(7)), ODOMCALIB_JUMP);
  EXPECT_EQ(update(opened.handle, far(8)), ODOMCALIB_OK);
  EXPECT_NEAR(x_after(opened.handle), 1.75 * x, 1e-8) << "but for the way between the two counters";
}

TEST(Library, a_stamp_that_goes_back_is_refused_and_a_clock_that_was_set_goes_on) {
  const auto opened = open(to_json(accepted()));
  for (int k = 0; k < 5; ++k) ASSERT_EQ(update(opened.handle, ahead(k)), ODOMCALIB_OK);
  const double x = x_after(opened.handle);
  EXPECT_EQ(update(opened.handle, ahead(4)), ODOMCALIB_STAMP_NOT_LATER);
  EXPECT_EQ(update(opened.handle, ahead(3)), ODOMCALIB_STAMP_NOT_LATER);
  EXPECT_THAT(odomcalib_odometry_problem(opened.handle.get()), HasSubstr("no later than the one before"));
  EXPECT_EQ(x_after(opened.handle), x);
  const auto set_back = [](int k) {
    return TickSample{0.02 * k - 1000.0, std::int64_t{100} * k, std::int64_t{100} * k, 0};
  };
  EXPECT_EQ(update(opened.handle, set_back(5)), ODOMCALIB_STAMP_NOT_LATER);
  EXPECT_EQ(update(opened.handle, set_back(6)), ODOMCALIB_OK);
  EXPECT_EQ(update(opened.handle, set_back(7)), ODOMCALIB_OK);
  EXPECT_NEAR(x_after(opened.handle), 1.5 * x, 1e-8);
}

TEST(Library, counters_wrap_where_the_options_say) {
  odomcalib_options options = ODOMCALIB_OPTIONS_INIT;
  options.counter_bits = 16;
  const auto opened = open(to_json(accepted()), &options), whole = open(to_json(accepted()));
  for (int k = 0; k < 2000; ++k) {
    const std::int64_t count = std::int64_t{100} * k;
    ASSERT_EQ(odomcalib_odometry_update_counts(opened.handle.get(), 0.02 * k, count % 65536,
                                               static_cast<std::int16_t>(count)),
              ODOMCALIB_OK);
    ASSERT_EQ(odomcalib_odometry_update_counts(whole.handle.get(), 0.02 * k, count, count), ODOMCALIB_OK);
  }
  EXPECT_NEAR(x_after(opened.handle), x_after(whole.handle), 1e-9);
}

TEST(Library, angles_and_speeds_lead_where_counts_do) {
  const double turn = 2.0 * std::numbers::pi / kRobot.ticks_per_rev;
  const auto counts = open(to_json(accepted())), angles = open(to_json(accepted())),
             speeds = open(to_json(accepted()));
  const Recording drive = some_drive();
  const TickSample& first = drive.ticks.front();
  for (std::size_t k = 0; k + 1 < drive.ticks.size(); ++k) {
    const TickSample &now = drive.ticks[k], &next = drive.ticks[k + 1];
    ASSERT_EQ(update(counts.handle, now), ODOMCALIB_OK);
    ASSERT_EQ(
        odomcalib_odometry_update_angles(angles.handle.get(), now.t, turn * static_cast<double>(now.left),
                                         turn * static_cast<double>(now.right)),
        ODOMCALIB_OK);
    const double held = next.t - now.t;
    ASSERT_EQ(odomcalib_odometry_update_speeds(speeds.handle.get(), now.t,
                                               turn * static_cast<double>(next.left - now.left) / held,
                                               turn * static_cast<double>(next.right - now.right) / held),
              ODOMCALIB_OK);
  }
  EXPECT_NE(first.left, drive.ticks.back().left);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(pose_of(angles.handle)[axis], pose_of(counts.handle)[axis], 1e-9);
    EXPECT_NEAR(pose_of(speeds.handle)[axis], pose_of(counts.handle)[axis], 1e-3);
  }
  EXPECT_EQ(odomcalib_odometry_update_counts(angles.handle.get(), 1e3, 0, 0), ODOMCALIB_OTHER_MOTION);
  EXPECT_EQ(odomcalib_odometry_update_speeds(speeds.handle.get(), 1e3, 1e6, 0.0), ODOMCALIB_JUMP);
}

TEST(Library, a_calibration_that_cannot_be_used_says_why) {
  Calibration refused = accepted();
  refused.verdict = Verdict::refused;
  refused.reasons = {"too few pairs"};
  const auto no = open(to_json(refused));
  EXPECT_EQ(no.status, ODOMCALIB_REFUSED);
  EXPECT_EQ(no.handle, nullptr);
  EXPECT_THAT(no.problem, HasSubstr("too few pairs"));
  odomcalib_options options = ODOMCALIB_OPTIONS_INIT;
  options.use_refused = 1;
  EXPECT_EQ(open(to_json(refused), &options).status, ODOMCALIB_OK);

  auto newer = nlohmann::json::parse(to_json(accepted()));
  newer["format"] = "odomcalib-calibration/2";
  const auto other = open(newer.dump());
  EXPECT_EQ(other.status, ODOMCALIB_OTHER_VERSION);
  EXPECT_THAT(other.problem, HasSubstr("odomcalib-calibration/2"));
  EXPECT_EQ(open("{").status, ODOMCALIB_NOT_A_CALIBRATION);

  Calibration uncounted = accepted();
  uncounted.robot.ticks_per_rev = 0.0;
  const auto counts = open(to_json(uncounted));
  EXPECT_EQ(counts.status, ODOMCALIB_NOT_A_CALIBRATION);
  EXPECT_THAT(counts.problem, HasSubstr("counts_per_turn"));
  options.counts_per_turn = 4096.0;
  EXPECT_EQ(open(to_json(uncounted), &options).status, ODOMCALIB_OK);

  odomcalib_odometry* odometry = nullptr;
  std::array<char, 20> problem{};
  EXPECT_EQ(odomcalib_odometry_open("/nowhere/cal.json", nullptr, &odometry, problem.data(), problem.size()),
            ODOMCALIB_CANNOT_READ);
  EXPECT_STREQ(problem.data(), "/nowhere/cal.json: ") << "cut off where the caller's memory ends";
  options.counter_bits = 7;
  EXPECT_EQ(open(to_json(accepted()), &options).status, ODOMCALIB_INVALID_ARGUMENT);
  EXPECT_EQ(odomcalib_odometry_pose(nullptr, nullptr), ODOMCALIB_INVALID_ARGUMENT);
  EXPECT_STREQ(odomcalib_status_name(ODOMCALIB_JUMP), "JUMP");
  EXPECT_STREQ(odomcalib_status_name(99), "UNKNOWN");
}

TEST(Library, says_which_effects_it_applies_and_which_it_leaves_out) {
  Calibration calibration = accepted();
  for (const char* name : {"backlash", "time_offset", "carpet", "scan_skew"})
    calibration.effects.push_back(result_of(*terms::find_effect(name)));
  calibration.effects.push_back({"range_bias", {{"offset", {0.02, 1e-3, "m"}}}, {}, {}, "host"});
  calibration.effects.push_back({"of_tomorrow", {{"k", {0.02, 1e-3, "m"}}}, {}, {}, "host"});
  const auto opened = open(to_json(calibration));
  std::map<std::string, int> places;
  std::map<std::string, std::string> reasons;
  for (std::size_t k = 0; k < odomcalib_odometry_effect_count(opened.handle.get()); ++k) {
    odomcalib_effect effect{};
    effect.size = sizeof(effect);
    ASSERT_EQ(odomcalib_odometry_effect(opened.handle.get(), k, &effect), ODOMCALIB_OK);
    places[effect.name] = effect.place;
    reasons[effect.name] = effect.why;
  }
  EXPECT_EQ(places.at("backlash.left_play"), ODOMCALIB_IN_POSE);
  EXPECT_EQ(places.at("time_offset.offset"), ODOMCALIB_IN_STAMPS);
  EXPECT_EQ(places.at("time_offset.smoothing"), ODOMCALIB_IN_POSE);
  EXPECT_EQ(places.at("range_bias.offset"), ODOMCALIB_IN_SCANS);
  EXPECT_EQ(places.at("carpet.p_x"), ODOMCALIB_LEFT_OUT);
  EXPECT_THAT(reasons.at("carpet.p_x"), HasSubstr("belongs to the place"));
  EXPECT_THAT(reasons.at("scan_skew.c"), HasSubstr("bends scans"));
  EXPECT_THAT(reasons.at("of_tomorrow"), HasSubstr("does not know it"));
  EXPECT_FALSE(places.contains("of_tomorrow.k"));
  EXPECT_EQ(odomcalib_odometry_clock_offset(opened.handle.get()), 0.02);
}

TEST(Library, beams_are_corrected_as_the_program_corrects_scans) {
  Scan scan;
  scan.ranges = {1.0F, 2.5F, 0.0F, 7.0F};
  scan.angle_min = -1.0;
  scan.angle_increment = 0.7;
  Calibration calibration = accepted();
  std::vector<terms::LidarFinding> findings;
  for (const auto& effect : terms::lidar_catalogue(false)) {
    std::vector<double> values(effect->parameters().size(), 0.011);
    const std::vector<double> deviations(values.size(), 1e-4);
    EffectResult result;
    result.name = effect->name();
    result.parameters = effect->quantities(values, deviations);
    calibration.effects.push_back(result);
    findings.push_back({effect, values, deviations, 1.0, 0.0, 0.0});
  }
  const Scan expected = corrected(scan, findings);
  const auto opened = open(to_json(calibration));
  std::vector<float> bearings, ranges = scan.ranges;
  for (std::size_t k = 0; k < ranges.size(); ++k) bearings.push_back(static_cast<float>(scan.angle(k)));
  ASSERT_EQ(odomcalib_odometry_correct_beams(opened.handle.get(), ranges.size(), bearings.data(),
                                             ranges.data(), bearings.data(), ranges.data()),
            ODOMCALIB_OK);
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    EXPECT_NEAR(ranges[k], expected.ranges[k], 1e-6);
    EXPECT_NEAR(bearings[k], expected.angles[k], 1e-6);
  }
}

TEST(Library, a_pose_that_is_set_goes_on_from_there) {
  const auto opened = open(to_json(accepted()));
  for (int k = 0; k < 5; ++k) update(opened.handle, ahead(k));
  const double way = x_after(opened.handle);
  const std::array<double, 3> there = {1.0, 2.0, std::numbers::pi / 2.0};
  ASSERT_EQ(odomcalib_odometry_set_pose(opened.handle.get(), there.data()), ODOMCALIB_OK);
  // The left wheel is a little larger: the base turns, and begins to from the new heading.
  for (int k = 5; k < 9; ++k) update(opened.handle, ahead(k));
  EXPECT_NEAR(pose_of(opened.handle)[1] - 2.0, way, 1e-5);
  const std::array<double, 3> nowhere = {kNaN, 0.0, 0.0};
  EXPECT_EQ(odomcalib_odometry_set_pose(opened.handle.get(), nowhere.data()), ODOMCALIB_NOT_A_NUMBER);
}

TEST(Library, velocity_and_lidar_pose_are_those_of_the_calibration) {
  Calibration calibration = accepted();
  EXPECT_EQ(
      odomcalib_odometry_lidar_pose(open(to_json(calibration)).handle.get(), std::array<double, 3>{}.data()),
      ODOMCALIB_NOT_KNOWN);
  for (const char* name : {"lidar_x", "lidar_y", "lidar_yaw"})
    calibration.parameters.push_back({name, {0.2, 0.1, name == std::string("lidar_yaw") ? "rad" : "m"}});
  const auto opened = open(to_json(calibration));
  std::array<double, 3> lidar{}, velocity{};
  EXPECT_EQ(odomcalib_odometry_lidar_pose(opened.handle.get(), lidar.data()), ODOMCALIB_OK);
  EXPECT_THAT(lidar, ::testing::Each(0.2));
  for (int k = 0; k < 5; ++k) update(opened.handle, ahead(k));
  ASSERT_EQ(odomcalib_odometry_velocity(opened.handle.get(), velocity.data()), ODOMCALIB_OK);
  const double speed = 1.002 * 0.15 * std::numbers::pi * 100.0 / kRobot.ticks_per_rev / 0.02;
  EXPECT_NEAR(velocity[0], speed, 1e-9);
  EXPECT_NEAR(velocity[1], 0.0, 1e-12);
}

}  // namespace
}  // namespace odomcalib::calib::library::library_test
