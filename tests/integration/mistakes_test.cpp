// Mistakes that people make with recordings: each is put into a sound one, or written as a file, and the
// program must say what is wrong, where, and what to do next, with the right exit status.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <random>

#include "calib/solve.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "proto/recording/recording.hpp"
#include "tests/sim/world/rooms.hpp"
#include "tests/sim/world/simulate.hpp"

namespace odomcalib::mistakes_test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

constexpr double kPi = std::numbers::pi;
constexpr double kDate = 1.7e9;  // s since 1970

const sim::SimulatedRun& plain_run() {
  static const sim::SimulatedRun run = [] {
    sim::SimulationConfig config = sim::standard_config(9);
    config.duration = 150.0;
    return sim::simulate_recording(config, sim::follow(config.nominal, sim::guided_pattern(0.8)));
  }();
  return run;
}

/// The same drive with the true poses as reference instead of scans.
Recording with_poses() {
  Recording recording = plain_run().recording;
  recording.scans.clear();
  std::mt19937 engine(3);
  std::normal_distribution<double> noise(0.0, 5e-4);
  for (const sim::TruthSample& sample : plain_run().path)
    recording.poses.push_back({sample.t, sample.pose.x + noise(engine), sample.pose.y + noise(engine),
                               sample.pose.yaw + noise(engine)});
  return recording;
}

/// The same drive with the robot's own odometry, by the nominal lengths, as reference instead of scans.
Recording with_own_odometry() {
  Recording recording = plain_run().recording;
  recording.scans.clear();
  const RobotDescription& robot = recording.robot;
  double x = 0.0, y = 0.0, yaw = 0.0;
  for (std::size_t k = 1; k < recording.ticks.size(); ++k) {
    const TickSample &from = recording.ticks[k - 1], &to = recording.ticks[k];
    const double left = kPi * robot.left_wheel_diameter * static_cast<double>(to.left - from.left) /
                        robot.ticks_per_rev,
                 right = kPi * robot.right_wheel_diameter * static_cast<double>(to.right - from.right) /
                         robot.ticks_per_rev;
    const double turn = (right - left) / robot.track_width;
    x += 0.5 * (left + right) * std::cos(yaw + 0.5 * turn);
    y += 0.5 * (left + right) * std::sin(yaw + 0.5 * turn);
    yaw += turn;
    recording.poses.push_back({to.t, x, y, std::remainder(yaw, 2.0 * kPi)});
  }
  return recording;
}

struct Outcome {
  std::string text;
  int status = 0;
};

/// As `solve` reads, solves and exits.
Outcome solved(const std::filesystem::path& path) {
  const auto recording = read_recording(path);
  if (!recording) return {recording.error().text(), cli::exit_status(recording.error().code)};
  const Calibration result = calib::solve({&recording.value(), 1}, {});
  Outcome outcome;
  for (const std::string& reason : result.reasons) outcome.text += reason + "\n";
  outcome.status = result.verdict == Verdict::refused ? cli::kRefused : cli::kDone;
  return outcome;
}

class Folder {
 public:
  Folder() {
    std::string name = "/tmp/odomcalib-mistakes-XXXXXX";
    path_ = mkdtemp(name.data());
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { std::filesystem::remove_all(path_); }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

using Edit = std::function<void(Recording&)>;

struct Mistake {
  std::string name;
  Edit make;
  std::string says;  ///< a regular expression of what is wrong
  std::string next;  ///< part of what to do
  int status = cli::kRefused;
  bool of_poses = false;
};

std::ostream& operator<<(std::ostream& out, const Mistake& mistake) { return out << mistake.name; }

enum Streams : unsigned { kTicks = 1, kReference = 2, kAll = 3 };

Edit stamps(const std::function<double(double)>& change, unsigned streams = kAll) {
  return [=](Recording& r) {
    if ((streams & kTicks) != 0)
      for (auto& one : r.ticks) one.t = change(one.t);
    if ((streams & kReference) == 0) return;
    for (auto& one : r.scans) one.t = change(one.t);
    for (auto& one : r.poses) one.t = change(one.t);
  };
}

Edit stretched(double factor, unsigned streams = kAll) {
  return stamps([=](double t) { return factor * t; }, streams);
}

Edit dated(double per_second, unsigned streams = kAll) {
  return stamps([=](double t) { return per_second * (kDate + t); }, streams);
}

Edit rounded(double step, unsigned streams = kAll) {
  return stamps([=](double t) { return step * std::floor(t / step); }, streams);
}

Edit ranges(double factor, bool limits = true) {
  return [=](Recording& r) {
    for (Scan& scan : r.scans) {
      for (float& range : scan.ranges) range = static_cast<float>(range * factor);
      if (limits) scan.range_min *= factor, scan.range_max *= factor;
    }
  };
}

Edit without_limits(double factor) {
  return [=](Recording& r) {
    ranges(factor)(r);
    for (Scan& scan : r.scans) scan.range_min = scan.range_max = 0.0;
  };
}

Edit of_scans(const std::function<void(Scan&)>& change) {
  return [=](Recording& r) {
    for (Scan& scan : r.scans) change(scan);
  };
}

Edit angles(double factor, double more = 0.0) {
  return of_scans([=](Scan& scan) {
    scan.angle_min = factor * scan.angle_min + more;
    scan.angle_increment *= factor;
  });
}

Edit beam_times(double factor) {
  return of_scans([=](Scan& scan) { *scan.time_increment *= factor; });
}

/// A lidar that sees no farther than `reach`, and writes a number where nothing came back.
Edit no_return_is(float number, float reach) {
  return of_scans([=](Scan& scan) {
    for (float& range : scan.ranges)
      if (range == 0.0F || range > reach) range = number;
  });
}

Edit of_robot(const std::function<void(RobotDescription&)>& change) {
  return [=](Recording& r) { change(r.robot); };
}

Edit diameters(double factor) {
  return of_robot([=](RobotDescription& robot) {
    robot.left_wheel_diameter *= factor;
    robot.right_wheel_diameter *= factor;
  });
}

/// The drive is one whose lengths come out near their nominal values with half of the angle between beams
/// too.
void diameter_is_radius(Recording& r) {
  sim::SimulationConfig config = sim::standard_config(11);
  config.room = sim::random_room(11);
  config.lidar.beams_per_turn = 360;
  config.duration = sim::total_duration(sim::lazy_pattern());
  r = sim::simulate_recording(config, sim::follow(config.nominal, sim::lazy_pattern())).recording;
  diameters(0.48)(r);
}

Edit lengths(double factor) {
  return [=](Recording& r) {
    diameters(factor)(r);
    r.robot.track_width *= factor;
  };
}

Edit track(double factor) {
  return of_robot([=](RobotDescription& robot) { robot.track_width *= factor; });
}

Edit ticks_per_rev(double factor) {
  return of_robot([=](RobotDescription& robot) { robot.ticks_per_rev *= factor; });
}

/// Counts in each interval as they would have been counted.
Edit counted(const std::function<std::pair<std::int64_t, std::int64_t>(std::int64_t, std::int64_t)>& change) {
  return [=](Recording& r) {
    const std::vector<TickSample> given = r.ticks;
    for (std::size_t k = 1; k < given.size(); ++k) {
      const auto [left, right] =
          change(given[k].left - given[k - 1].left, given[k].right - given[k - 1].right);
      r.ticks[k].left = r.ticks[k - 1].left + left;
      r.ticks[k].right = r.ticks[k - 1].right + right;
    }
  };
}

void per_sample(Recording& r) {
  const std::vector<TickSample> given = r.ticks;
  for (std::size_t k = 0; k < given.size(); ++k) {
    r.ticks[k].left = k == 0 ? 0 : given[k].left - given[k - 1].left;
    r.ticks[k].right = k == 0 ? 0 : given[k].right - given[k - 1].right;
  }
}

Edit poses(const std::function<void(PoseSample&)>& change) {
  return [=](Recording& r) {
    for (PoseSample& pose : r.poses) change(pose);
  };
}

/// From the middle of the drive on.
Edit clock_of_counts(double ahead) {
  return stamps([=](double t) { return t > 75.0 ? t + ahead : t; }, kTicks);
}

/// The odometry that a robot computes from its counts, in the place of these.
Edit odometry(const std::function<void(PoseSample&)>& change) {
  return [=](Recording& r) {
    PoseSample pose;
    for (std::size_t k = 0; k < r.ticks.size(); ++k) {
      const double turns = kPi / r.robot.ticks_per_rev;
      const double left = k == 0 ? 0.0 : static_cast<double>(r.ticks[k].left - r.ticks[k - 1].left);
      const double right = k == 0 ? 0.0 : static_cast<double>(r.ticks[k].right - r.ticks[k - 1].right);
      const double left_way = turns * r.robot.left_wheel_diameter * left;
      const double right_way = turns * r.robot.right_wheel_diameter * right;
      const double turn = (right_way - left_way) / r.robot.track_width;
      pose.t = r.ticks[k].t;
      pose.x += 0.5 * (left_way + right_way) * std::cos(pose.yaw + 0.5 * turn);
      pose.y += 0.5 * (left_way + right_way) * std::sin(pose.yaw + 0.5 * turn);
      pose.yaw += turn;
      r.odometry.push_back(pose);
      change(r.odometry.back());
    }
    r.motion = MotionSource::odometry;
    r.ticks.clear();
  };
}

const std::vector<Mistake>& mistakes() {
  static const std::vector<Mistake> all = {
      // Time stamps.
      {"all_ms", stretched(1e3), "ticks come every 20 s: .*milliseconds", "in seconds"},
      {"all_us", stretched(1e6), "look like microseconds", "in seconds"},
      {"all_ns", stretched(1e9), "look like nanoseconds", "in seconds"},
      {"all_minutes", stretched(1.0 / 60.0), "look like minutes", "in seconds"},
      {"dates_ms", dated(1e3), "look like milliseconds since 1970", "in seconds", cli::kFailure},
      {"dates_us", dated(1e6), "look like microseconds since 1970", "in seconds", cli::kFailure},
      {"dates_ns", dated(1e9), "look like nanoseconds since 1970", "in seconds", cli::kFailure},
      {"dates_of_scans_ms", dated(1e3, kReference), "stamps of [0-9]+ scans look like milliseconds since",
       "in seconds"},
      {"dates_of_ticks_ns", dated(1e9, kTicks), "stamps of [0-9]+ ticks look like nanoseconds since",
       "in seconds"},
      {"ticks_ms", stretched(1e3, kTicks),
       "ticks come every 20 s: .*milliseconds|ticks look like milliseconds", "in seconds"},
      {"scans_ms", stretched(1e3, kReference), "scans.* look like milliseconds", "in seconds"},
      {"ticks_minutes", stretched(1.0 / 60.0, kTicks), "ticks look like minutes", "in seconds"},
      {"two_clocks", dated(1.0, kReference), "ticks run from 0 to .* scans run from 1.7", "same clock"},
      {"scans_3_s_late", stamps([](double t) { return t + 3.0; }, kReference), "lidar are 3 s late",
       "same clock"},
      {"scan_clock_at_half", stretched(0.5, kReference), "stamps of the scans run too slowly", "clock"},
      {"tick_clock_at_half", stretched(0.5, kTicks), "runs at 2 times the rate", "same clock"},
      {"whole_seconds", rounded(1.0), "lost their last digits", "three digits"},
      {"ticks_in_whole_seconds", rounded(1.0, kTicks), "ticks carry the same time stamp", "three digits"},
      {"single_precision_dates", stamps([](double t) { return 128.0 * std::floor((kDate + t) / 128.0); }),
       "lost their last digits", "double-precision"},
      {"beam_times_us", beam_times(1e6), "time_increment or times are not in seconds", "leave it out"},
      {"beam_times_ms", beam_times(1e3), "time_increment or times are not in seconds", "leave it out"},
      // Ranges and angles.
      {"ranges_mm", ranges(1e3), "look like millimetres",
       "multiply ranges, range_min and range_max by 0.001"},
      {"ranges_mm_without_limits", without_limits(1e3), "look like millimetres", "by 0.001"},
      {"ranges_mm_limits_m", ranges(1e3, false),
       "readings lie outside range_min and range_max.*look like millimetres", "multiply the ranges by 0.001"},
      {"ranges_cm_limits_m", ranges(1e2, false),
       "readings lie outside range_min and range_max.*look like centimetres", "multiply the ranges by 0.01"},
      {"ranges_cm", ranges(1e2), "look like centimetres", "by 0.01"},
      {"ranges_inches", ranges(1.0 / 0.0254), "look like inches", "by 0.0254"},
      {"ranges_km", ranges(1e-3), "look like kilometres", "by 1000"},
      {"ranges_feet", ranges(1.0 / 0.3048), "both wheel diameters and the track width .*feet", "tape"},
      {"ranges_halved", ranges(0.5), "0.49[0-9]* times .*halved twice", "tape"},
      {"ranges_doubled", ranges(2.0), "1.9[0-9]* times .*not halved", "tape", cli::kDone},
      {"angles_in_degrees", angles(180.0 / kPi), "angles look like degrees", "in radians"},
      {"angles_a_third_wider", angles(4.0 / 3.0), "angles are stretched", "angle_increment"},
      {"angles_half_as_wide", angles(0.5), "0.5 times as wide as they are", "angle_increment"},
      {"lidar_turns_the_other_way", angles(-1.0), "angles run the other way", "put it right"},
      {"lidar_backwards", angles(1.0, kPi),
       "lidar_yaw differs from its nominal value by -?1[78][0-9] degrees", "correct lidar_pose", cli::kDone},
      {"no_return_is_4_m", no_return_is(4.0F, 4.0F), "exactly 4 m", "null says the same", cli::kDone},
      {"lidar_covered", of_scans([](Scan& s) { std::fill(s.ranges.begin(), s.ranges.end(), 0.0F); }),
       "no scan has a reading", "covers the lidar"},
      {"lidar_repeats_itself",
       [](Recording& r) {
         for (Scan& s : r.scans) s.ranges = r.scans[0].ranges;
       },
       "same values as the one before, although the wheels turned", "lidar"},
      {"angles_missing", of_scans([](Scan& s) { s.angle_increment = 0.0; }),
       "left out, angle_min or angle_increment missing", "lidar"},
      // The robot.
      {"diameter_in_mm", diameters(1e3), "wheel_diameter.* at most 10", "in m", cli::kFailure},
      {"diameter_in_inches", diameters(1.0 / 0.0254), "wheel_diameter is in inches",
       "wheel_diameter to 0.15 m"},
      {"lengths_in_inches", lengths(1.0 / 0.0254), "wheel_diameter and track_width are in inches", "tape"},
      {"radius", diameters(0.5), "the radius was given as diameter", "wheel_diameter to 0.15 m", cli::kDone},
      {"diameter_is_radius", diameter_is_radius, "the radius was given as diameter",
       "wheel_diameter to 0.14"},
      {"circumference", diameters(kPi), "the circumference was given as diameter",
       "wheel_diameter to 0.15 m"},
      {"half_track", track(0.5), "track_width comes out 1.9.*middle of the robot to a wheel",
       "set track_width to about 0.4 m", cli::kDone},
      {"track_in_cm", track(100.0), "track_width.*(at most 50|centimetres)", "m"},
      {"quadrature_counted_once", ticks_per_rev(4.0), "3.9[0-9]* times .*all four edges",
       "ticks_per_rev to 16384 "},
      {"quadrature_counted_fourfold", ticks_per_rev(0.25), "one edge of a period", "ticks_per_rev to 16384 "},
      {"counts_of_the_motor", ticks_per_rev(1.0 / 20.0), "0.049[0-9]* times .*before a gear",
       "ticks_per_rev to about 16"},
      {"gear_of_three_halves", ticks_per_rev(1.5), "1.4[0-9]* times .*gear ratio",
       "ticks_per_rev to about 16", cli::kDone},
      {"counts_per_radian", ticks_per_rev(0.5 / kPi), "counts per radian", "ticks_per_rev to 16384 "},
      {"lidar_pose_in_mm", of_robot([](RobotDescription& r) {
         r.lidar_pose = {100.0, 0.0, 0.0};
       }),
       "lidar_pose puts the lidar 100 m", "in metres"},
      {"lidar_pose_in_degrees", of_robot([](RobotDescription& r) {
         r.lidar_pose = {0.1, 0.0, 90.0};
       }),
       "lidar_pose .*degrees", "in radians"},
      // Counts.
      {"counts_exchanged", counted([](auto l, auto r) { return std::pair(r, l); }),
       "left and right counts are exchanged", "put it right"},
      {"left_counts_backwards", counted([](auto l, auto r) { return std::pair(-l, r); }),
       "left wheel counts backwards", "put it right"},
      {"both_count_backwards", counted([](auto l, auto r) { return std::pair(-l, -r); }),
       "both wheels count backwards", "put it right"},
      {"counts_without_direction",
       counted([](auto l, auto r) { return std::pair(std::abs(l), std::abs(r)); }),
       "both wheels only ever grow", "quadrature"},
      {"left_counts_without_direction", counted([](auto l, auto r) { return std::pair(std::abs(l), r); }),
       "the left wheel only ever grow", "quadrature"},
      {"counts_that_only_fall", counted([](auto l, auto r) { return std::pair(-std::abs(l), -std::abs(r)); }),
       "both wheels only ever fall", "quadrature"},
      {"counts_that_grow_and_fall",
       counted([](auto l, auto r) { return std::pair(std::abs(l), -std::abs(r)); }),
       "the left wheel only ever grow, those of the right only ever fall", "quadrature"},
      {"one_encoder_twice", counted([](auto l, auto) { return std::pair(l, l); }), "always the same",
       "its own encoder"},
      {"left_counts_twice", counted([](auto l, auto r) { return std::pair(2 * l, r); }),
       "left wheel diameter comes out 0.4", "same resolution"},
      {"counts_per_sample", per_sample, "since the sample before", "cumulative"},
      {"left_encoder_dead", counted([](auto, auto r) { return std::pair(std::int64_t{0}, r); }),
       "counts of the left wheel never change", "cable"},
      // Odometry in the place of counts.
      {"odometry_beside_the_axle",
       odometry([](PoseSample& p) { p.x -= 0.1 * std::sin(p.yaw), p.y += 0.1 * std::cos(p.yaw); }),
       "a frame 0\\.(099|10[01]) m to the left of the middle of the axle", "base_link"},
      {"odometry_on_the_other_side_of_the_axle",
       odometry([](PoseSample& p) { p.x += 0.06 * std::sin(p.yaw), p.y -= 0.06 * std::cos(p.yaw); }),
       "a frame 0\\.0(59|6[01]) m to the right of the middle of the axle", "base_link"},
      {"odometry_north_east_down", odometry([](PoseSample& p) { p.y = -p.y, p.yaw = -p.yaw; }),
       "y and yaw of the odometry run the other way.*north-east-down", "put it right"},
      {"odometry_that_looks_backwards", odometry([](PoseSample& p) { p.yaw += kPi; }),
       "the odometry looks backwards", "correct lidar_pose"},
      // Clocks that are set while recording.
      {"clock_of_counts_set_back", clock_of_counts(-0.4), "counts step by -0\\.40 s at 75", "let nothing set",
       cli::kDone},
      {"clock_of_counts_set_back_by_seconds", clock_of_counts(-3.0), "counts step by -3\\.00 s at 75",
       "let nothing set", cli::kDone},
      {"clock_of_counts_set_ahead_by_a_minute", clock_of_counts(60.0), "counts step by 60\\.00 s at 7[45]",
       "let nothing set", cli::kDone},
      // Poses as reference.
      {"poses_north_east_down", poses([](PoseSample& p) { p.y = -p.y, p.yaw = -p.yaw; }), "north-east-down",
       "put it right", cli::kRefused, true},
      {"pose_yaw_in_degrees", poses([](PoseSample& p) { p.yaw *= 180.0 / kPi; }), "yaw looks like degrees",
       "pi / 180", cli::kRefused, true},
      {"pose_yaw_of_a_compass", poses([](PoseSample& p) { p.yaw = 0.5 * kPi - p.yaw; }), "compass",
       "pi / 2 - yaw", cli::kRefused, true},
      {"pose_yaw_missing", poses([](PoseSample& p) { p.yaw = 0.0; }), "yaw never changes", "heading",
       cli::kRefused, true},
      {"pose_of_a_quaternion", poses([](PoseSample& p) { p.yaw *= 0.5; }), "half of the heading", "atan2",
       cli::kRefused, true},
      {"poses_are_odometry", [](Recording& r) { r = with_own_odometry(); }, "computed of the wheels",
       "something else measures", cli::kRefused, true},
      {"poses_in_mm", poses([](PoseSample& p) { p.x *= 1e3, p.y *= 1e3; }), "in millimetres",
       "x and y of the poses", cli::kRefused, true},
      {"poses_in_cm", poses([](PoseSample& p) { p.x *= 1e2, p.y *= 1e2; }), "in centimetres",
       "x and y of the poses", cli::kRefused, true},
      {"poses_look_backwards", poses([](PoseSample& p) { p.yaw += kPi; }), "looks backwards", "3.14 rad",
       cli::kRefused, true},
  };
  return all;
}

class Mistakes : public ::testing::TestWithParam<Mistake> {};

TEST_P(Mistakes, are_told_with_what_where_and_what_next) {
  const Mistake& mistake = GetParam();
  const Folder folder;
  Recording recording = mistake.of_poses ? with_poses() : plain_run().recording;
  mistake.make(recording);
  const auto path = folder.file("drive.jsonl");
  ASSERT_TRUE(write_recording_jsonl(recording, path).ok());
  const Outcome outcome = solved(path);
  EXPECT_EQ(outcome.status, mistake.status);
  EXPECT_THAT(outcome.text, ContainsRegex(mistake.says));
  EXPECT_THAT(outcome.text, HasSubstr(mistake.next));
}

INSTANTIATE_TEST_SUITE_P(ByHand, Mistakes, ::testing::ValuesIn(mistakes()),
                         [](const auto& mistake) { return mistake.param.name; });

/// A straight metre and back towards the upper right of the map, seen by poses.
Recording straight_metre() {
  constexpr double kHeading = 0.5, kSpeed = 0.2;  // rad, m/s
  Recording recording;
  recording.robot = plain_run().recording.robot;
  std::mt19937 engine(3);
  std::normal_distribution<double> noise(0.0, 5e-4);
  for (int k = 0; k <= 600; ++k) {
    const double t = 0.02 * k, way = kSpeed * (t < 6.0 ? t : 12.0 - t);
    const auto count =
        std::llround(way / (kPi * recording.robot.left_wheel_diameter) * recording.robot.ticks_per_rev);
    recording.ticks.push_back({t, count, count});
    recording.poses.push_back({t, way * std::cos(kHeading) + noise(engine),
                               way * std::sin(kHeading) + noise(engine), kHeading + noise(engine)});
  }
  return recording;
}

// Nothing turns, so that the frame shows in the direction of the way alone.
TEST(StraightMetre, with_yaw_negated_is_told_the_sign_and_not_to_record_again) {
  Recording recording = straight_metre();
  const auto reasons = [&] {
    std::string text;
    for (const std::string& reason : calib::solve({&recording, 1}, {}).reasons) text += reason + "\n";
    return text;
  };
  EXPECT_THAT(reasons(), HasSubstr("turns on the spot")) << "sound, but there is no turn in it";
  for (PoseSample& pose : recording.poses) pose.yaw = -pose.yaw;
  EXPECT_THAT(reasons(), HasSubstr("negate yaw"));
  EXPECT_THAT(reasons(), ::testing::Not(HasSubstr("turns on the spot")));
}

// The recordings that the table changes, without a mistake.
TEST(MistakesNone, of_a_sound_recording_are_told) {
  for (const bool of_poses : {false, true}) {
    const Recording recording = of_poses ? with_poses() : plain_run().recording;
    const Calibration result = calib::solve({&recording, 1}, {});
    EXPECT_EQ(result.verdict, Verdict::accepted) << result.reasons.size();
    for (const std::string& reason : result.reasons) ADD_FAILURE() << reason;
  }
}

TEST(MistakesNone, of_sound_odometry_are_told) {
  Recording recording = plain_run().recording;
  odometry([](PoseSample&) {})(recording);
  const Folder folder;
  ASSERT_TRUE(write_recording_jsonl(recording, folder.file("drive.jsonl")).ok());
  const Outcome outcome = solved(folder.file("drive.jsonl"));
  EXPECT_EQ(outcome.status, cli::kDone);
  EXPECT_EQ(outcome.text, "");
}

// Beams in whatever order a driver lists them give the same calibration, to the last digit.
TEST(MistakesNone, are_made_of_beams_in_another_order) {
  const auto listed = [](bool backwards) {
    Recording recording = plain_run().recording;
    for (Scan& scan : recording.scans) {
      for (std::size_t k = 0; k < scan.ranges.size(); ++k) {
        scan.angles.push_back(
            static_cast<float>(scan.angle(0) + scan.angle_increment * static_cast<double>(k)));
        scan.times.push_back(static_cast<float>(*scan.time_increment * static_cast<double>(k)));
      }
      scan.time_increment.reset();
      if (!backwards) continue;
      std::reverse(scan.ranges.begin(), scan.ranges.end());
      std::reverse(scan.angles.begin(), scan.angles.end());
      std::reverse(scan.times.begin(), scan.times.end());
      std::reverse(scan.intensities.begin(), scan.intensities.end());
    }
    const Folder folder;
    EXPECT_TRUE(write_recording_jsonl(recording, folder.file("drive.jsonl")).ok());
    const auto read = read_recording(folder.file("drive.jsonl"));
    return calib::solve({&read.value(), 1}, {});
  };
  const Calibration ahead = listed(false), back = listed(true);
  ASSERT_FALSE(ahead.parameters.empty());
  for (const auto& [name, quantity] : ahead.parameters)
    EXPECT_EQ(quantity.value, back.parameter(name).value_or(0.0)) << name;
}

struct WrongFile {
  std::string name, content, says, next;
};

std::ostream& operator<<(std::ostream& out, const WrongFile& file) { return out << file.name; }

const std::string kRobotLine =
    R"({"type":"robot","wheel_diameter":0.15,"track_width":0.4,"ticks_per_rev":100})"
    "\n";

const std::vector<WrongFile>& wrong_files() {
  static const std::vector<WrongFile> all = {
      {"empty", "", "holds no data", "record again"},
      {"csv", "t,left,right\n0,1,2\n0.1,3,4\n", "known format", "JSON Lines"},
      {"picture", "\x89PNG\r\n\x1a\n....", "known format", "JSON Lines"},
      {"xml", "<xml></xml>", "known format", "JSON Lines"},
      {"robot_file", "[robot]\nwheel_diameter = 0.15\n", "known format", "JSON Lines"},
      {"calibration", "{\n  \"format\": \"odomcalib-calibration/1\",\n  \"verdict\": \"accepted\"\n}\n",
       "is a calibration, not a recording", "odomcalibctl report"},
      {"pose_graph", "VERTEX_SE2 0 0 0 0\n", "is a pose graph", "odomcalibctl graph"},
      {"one_json_list", "[{\"type\":\"ticks\",\"t\":0,\"left\":0,\"right\":0}]\n", "known format",
       "JSON Lines"},
      {"other_json", "{\"ranges\": [1,2,3]}\n", "no usable wheel motion.*no type", "formats"},
      {"python_quotes", "{'type':'ticks','t':0,'left':0,'right':0}\n{'type':'ticks'}\n",
       "no usable wheel motion.*not valid JSON", "formats"},
      {"type_in_capitals", kRobotLine + "{\"type\":\"Ticks\",\"t\":0,\"left\":0,\"right\":0}\n",
       "no usable wheel motion.*unknown type", "formats"},
      {"time_instead_of_t", kRobotLine + "{\"type\":\"ticks\",\"time\":0,\"left\":0,\"right\":0}\n",
       "no usable wheel motion.*time stamp missing", "formats"},
      {"counts_with_a_point", kRobotLine + "{\"type\":\"ticks\",\"t\":0,\"left\":0.5,\"right\":0.5}\n",
       "no usable wheel motion.*not a whole number", "formats"},
      {"no_track",
       R"({"type":"robot","wheel_diameter":0.15,"ticks_per_rev":100})"
       "\n{\"type\":\"ticks\",\"t\":0,\"left\":0,\"right\":0}\n",
       "lacks \"track_width\"", "in m"},
      {"negative_diameter",
       R"({"type":"robot","wheel_diameter":-0.15,"track_width":0.4,"ticks_per_rev":100})"
       "\n{\"type\":\"ticks\",\"t\":0,\"left\":0,\"right\":0}\n",
       "must be greater than 0", "in m"},
  };
  return all;
}

class WrongFiles : public ::testing::TestWithParam<WrongFile> {};

TEST_P(WrongFiles, are_told_with_what_where_and_what_next) {
  const Folder folder;
  const auto path = folder.file("drive.jsonl");
  std::ofstream(path, std::ios::binary) << GetParam().content;
  const Outcome outcome = solved(path);
  EXPECT_EQ(outcome.status, cli::kFailure);
  EXPECT_THAT(outcome.text, HasSubstr(path.string()));
  EXPECT_THAT(outcome.text, ContainsRegex(GetParam().says));
  EXPECT_THAT(outcome.text, HasSubstr(GetParam().next));
}

INSTANTIATE_TEST_SUITE_P(ByHand, WrongFiles, ::testing::ValuesIn(wrong_files()),
                         [](const auto& file) { return file.param.name; });

}  // namespace
}  // namespace odomcalib::mistakes_test
