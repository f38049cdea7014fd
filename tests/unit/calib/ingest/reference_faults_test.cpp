// Faults of the reference that are undone, and clocks that were set, on streams made by hand.
#include "calib/ingest/reference_faults.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "calib/ingest/put_right.hpp"
#include "calib/ingest/stamp_check.hpp"

namespace odomcalib::calib::ingest::reference_faults_test {
namespace {

/// The third of a turn that begins after so many others, of 120 beams.
Scan third_of_turn(int number, const std::string& sensor = "") {
  Scan scan;
  scan.t = 0.04 * number;
  scan.angle_increment = kWholeTurn / 360.0;
  scan.angle_min = math::wrap_angle(static_cast<double>(number % 3) * kWholeTurn / 3.0);
  scan.ranges.assign(120, 1.0F + 0.01F * static_cast<float>(number));
  scan.sensor = sensor;
  return scan;
}

TEST(JoinedTurns, are_made_of_parts_that_go_on) {
  Recording recording;
  for (int k = 0; k < 60; ++k) recording.scans.push_back(third_of_turn(k));
  const auto joined = with_joined_turns(recording);
  ASSERT_TRUE(joined);
  ASSERT_EQ(joined->scans.size(), 20U);
  EXPECT_EQ(joined->scans[7].ranges.size(), 360U);
  EXPECT_EQ(joined->scans[7].t, recording.scans[21].t);
}

TEST(JoinedTurns, are_of_one_lidar) {
  Recording recording;
  for (int k = 0; k < 60; ++k) recording.scans.push_back(third_of_turn(k, k % 2 == 0 ? "front" : "rear"));
  EXPECT_FALSE(with_joined_turns(recording)) << "each part follows one of the other lidar";
}

/// Beam by beam what the grid says.
Scan listed(const Scan& part) {
  Scan scan = part;
  scan.angles.clear(), scan.times.clear();
  for (std::size_t beam = 0; beam < part.ranges.size(); ++beam) {
    scan.angles.push_back(static_cast<float>(part.angle(beam)));
    scan.times.push_back(1e-4F * static_cast<float>(beam));
  }
  scan.angle_min = scan.angle_increment = 0.0;
  return scan;
}

TEST(JoinedTurns, are_made_of_beams_with_bearings_and_times_of_their_own) {
  for (const int every : {1, 2}) {
    Recording recording;
    for (int k = 0; k < 60; ++k)
      recording.scans.push_back(k % every == 0 ? listed(third_of_turn(k)) : third_of_turn(k));
    const auto joined = with_joined_turns(recording);
    ASSERT_TRUE(joined) << every;
    ASSERT_EQ(joined->scans.size(), 20U);
    const Scan& turn = joined->scans[7];
    ASSERT_EQ(turn.ranges.size(), 360U);
    EXPECT_FALSE(turn.time_increment);
    for (const std::size_t beam : {0U, 119U, 120U, 359U}) {
      const double bearing = kWholeTurn * static_cast<double>(beam) / 360.0;
      EXPECT_NEAR(math::wrap_angle(turn.angle(beam) - bearing), 0.0, 1e-5);
      EXPECT_EQ(turn.ranges[beam], recording.scans[21 + beam / 120].ranges[beam % 120]);
    }
    if (every == 2) continue;
    EXPECT_NEAR(turn.times[121], 0.04 + 1e-4, 1e-6);
  }
}

/// Messages of so many beams each, a degree apart, over and over; a turn of the head takes 0.1 s.
std::vector<Scan> messages(const std::vector<std::size_t>& beams, int sweeps, double first = -2.0) {
  std::vector<Scan> all;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    std::size_t before = 0;
    for (const std::size_t count : beams) {
      Scan scan;
      scan.t = 0.1 * sweep + 0.1 * static_cast<double>(before) / 360.0;
      scan.angle_increment = kWholeTurn / 360.0;
      scan.angle_min = first + scan.angle_increment * static_cast<double>(before);
      scan.ranges.assign(count, 1.0F + 0.01F * static_cast<float>(sweep));
      all.push_back(std::move(scan));
      before += count;
    }
  }
  return all;
}

TEST(JoinedTurns, may_be_sweeps_of_a_lidar_that_does_not_see_all_round) {
  using Beams = std::vector<std::size_t>;
  for (const Beams& beams : {Beams(9, 30), Beams(3, 90), Beams(2, 90), Beams(6, 44), Beams{80, 80, 20}}) {
    Recording recording;
    recording.scans = messages(beams, 30);
    const auto joined = with_joined_turns(recording);
    ASSERT_TRUE(joined) << beams.size();
    ASSERT_EQ(joined->scans.size(), 30U) << beams.size();
    EXPECT_EQ(joined->scans[7].ranges.size(), std::accumulate(beams.begin(), beams.end(), std::size_t{0}));
    EXPECT_EQ(joined->scans[7].t, recording.scans[7 * beams.size()].t);
    EXPECT_NEAR(joined->scans[7].time_increment.value_or(0.0), 0.1 / 360.0, beams.size() == 3 ? 1e-4 : 1e-9);
    EXPECT_TRUE(joined->discarded.empty());
    EXPECT_EQ(joined->repairs.back().chosen, "joined from " + std::to_string(beams.size()) + " parts each");
  }
}

TEST(JoinedTurns, of_parts_of_unequal_size_have_all_of_them) {
  Recording recording;
  recording.scans = messages({160, 160, 40}, 30);
  const auto joined = with_joined_turns(recording);
  ASSERT_TRUE(joined);
  EXPECT_EQ(joined->scans.size(), 30U);
  EXPECT_EQ(joined->scans[3].ranges.size(), 360U);
}

TEST(JoinedTurns, leave_out_a_sweep_that_lacks_a_part) {
  for (const std::size_t lost : {90U, 94U, 98U}) {  // the first, the middle and the last of a sweep
    Recording recording;
    recording.scans = messages(std::vector<std::size_t>(9, 30), 30);
    recording.scans.erase(recording.scans.begin() + static_cast<std::ptrdiff_t>(lost));
    const auto joined = with_joined_turns(recording);
    ASSERT_TRUE(joined);
    EXPECT_EQ(joined->scans.size(), 29U);
    EXPECT_EQ(joined->discarded.back().count, 8U);
  }
}

TEST(JoinedTurns, stay_turns_where_parts_are_lost_now_and_then) {
  for (const std::size_t parts : {2U, 3U, 4U})
    for (const std::size_t every : {11U, 25U}) {
      Recording recording;
      const std::vector<Scan> all = messages(std::vector<std::size_t>(parts, 360 / parts), 60);
      for (std::size_t k = 0; k < all.size(); ++k)
        if (k % every != 7) recording.scans.push_back(all[k]);
      const auto joined = with_joined_turns(recording);
      ASSERT_TRUE(joined) << parts << " " << every;
      EXPECT_EQ(joined->scans.front().ranges.size(), 360U);
      EXPECT_EQ(joined->repairs.back().chosen, "joined from " + std::to_string(parts) + " parts each");
      EXPECT_EQ(joined->scans.size() * parts + joined->discarded.back().count, recording.scans.size());
    }
}

TEST(JoinedTurns, are_not_made_of_whole_sweeps) {
  Recording sweeps, turns, halves, to_and_fro;
  sweeps.scans = messages({270}, 60);
  turns.scans = messages({360}, 60);
  halves.scans = messages({360, 180}, 30);  // every second scan has half of the beams
  for (std::size_t k = 1; k < halves.scans.size(); k += 2) halves.scans[k].angle_min = -2.0;
  to_and_fro.scans = messages({270}, 60);
  for (std::size_t k = 1; k < to_and_fro.scans.size(); k += 2) {
    Scan& back = to_and_fro.scans[k];
    back.angle_min += 270.0 * back.angle_increment, back.angle_increment *= -1.0;
  }
  for (const Recording& recording : {sweeps, turns, halves, to_and_fro})
    EXPECT_FALSE(with_joined_turns(recording));
}

/// Poses of a steady way, 0.1 m from one to the next; the one of this number is sent again so many times.
Recording sent_again(std::size_t number, std::size_t times) {
  Recording recording;
  for (std::size_t k = 0; k < 20; ++k)
    for (std::size_t again = 0; again <= (k == number ? times : 0); ++again)
      recording.poses.push_back(
          {0.1 * static_cast<double>(recording.poses.size()), 0.1 * static_cast<double>(k), 0.0, 0.0});
  return recording;
}

TEST(RepeatedPoses, are_left_out_up_to_three_in_a_row) {
  for (const std::size_t times : {1U, 2U, 3U}) {
    const Recording recording = sent_again(10, times);
    const auto once = without_repeated_poses(recording);
    ASSERT_TRUE(once) << times;
    EXPECT_EQ(once->poses.size(), 20U) << times;
    EXPECT_EQ(once->poses[10].t, recording.poses[10].t) << "the first of them stays";
    EXPECT_EQ(once->discarded.back().count, times);
  }
  EXPECT_FALSE(without_repeated_poses(sent_again(10, 4))) << "the robot stands";
  EXPECT_FALSE(without_repeated_poses(sent_again(0, 2))) << "nothing shows that it moved before";
}

/// The same, and counts of a robot that rolls a tenth of the way from pose to pose all the time.
Recording held(std::size_t number, std::size_t times) {
  Recording recording = sent_again(number, times);
  recording.robot.left_wheel_diameter = recording.robot.right_wheel_diameter = 0.1 / math::kPi;
  recording.robot.ticks_per_rev = 1000.0;
  for (const PoseSample& pose : recording.poses) {
    const auto count = static_cast<std::int64_t>(1000.0 * pose.t);
    recording.ticks.push_back({pose.t, count, count});
  }
  return recording;
}

TEST(RepeatedPoses, are_left_out_where_one_is_held_while_the_wheels_turn) {
  for (const std::size_t number : {0U, 10U, 19U}) {  // before it moves, on the way, until the end
    const auto once = without_repeated_poses(held(number, 8));
    ASSERT_TRUE(once) << number;
    EXPECT_EQ(once->poses.size(), 20U) << number;
  }
  Recording standing = held(10, 8);
  for (TickSample& tick : standing.ticks) tick.left = tick.right = 0;
  EXPECT_FALSE(without_repeated_poses(standing));
  Recording never = held(0, 8);
  for (PoseSample& pose : never.poses) pose.x = 0.0;
  EXPECT_FALSE(without_repeated_poses(never)) << "nothing shows that it was a reference at all";
}

/// Both wheels roll 10 mm from sample to sample, but for those from `begin` to `end`, where the left one
/// stands. The track is 0.1 m, so that a turn about a wheel takes 63 samples.
Recording with_standing_left(std::size_t begin, std::size_t end) {
  Recording recording;
  recording.robot.left_wheel_diameter = recording.robot.right_wheel_diameter = 0.1 / math::kPi;
  recording.robot.track_width = 0.1;
  recording.robot.ticks_per_rev = 1000.0;
  std::int64_t left = 0, right = 0;
  for (std::size_t k = 0; k < 400; ++k) {
    recording.ticks.push_back({0.02 * static_cast<double>(k), left, right});
    right += 100;
    if (k < begin || k >= end) left += 100;
  }
  return recording;
}

TEST(DeadCounts, are_left_out_where_the_other_wheel_rolls_on) {
  const auto mended = without_dead_counts(with_standing_left(100, 240));
  ASSERT_TRUE(mended);
  EXPECT_EQ(mended->ticks.size(), 400U - 140U);
  EXPECT_EQ(mended->ticks[100].left, 100 * 100) << "the first of them stays";
  ASSERT_EQ(mended->discarded.size(), 1U);
  EXPECT_EQ(mended->discarded[0].count, 140U);
  EXPECT_EQ(mended->discarded[0].reason, "the left count stands still while the right wheel rolls");
  EXPECT_EQ(without_dead_counts(with_standing_left(200, 400))->ticks.size(), 201U) << "for good";
  EXPECT_FALSE(without_dead_counts(with_standing_left(100, 200))) << "a turn and a half about a wheel";
  EXPECT_FALSE(without_dead_counts(with_standing_left(0, 400))) << "it never counts: that is told";
}

/// Each scan comes again after so many seconds; the robot rolls 50 mm from scan to scan, and every so often
/// it stands for as long.
Recording scans_twice(double later, std::size_t rests_every) {
  Recording recording;
  recording.robot.left_wheel_diameter = recording.robot.right_wheel_diameter = 0.1 / math::kPi;
  recording.robot.ticks_per_rev = 1000.0;
  std::int64_t count = 0;
  for (std::size_t k = 0; k < 30; ++k) {
    const double t = 0.1 * static_cast<double>(k);
    const bool rests = rests_every > 0 && k % rests_every < 3;
    if (!rests) count += 500;
    recording.ticks.push_back({t, count, count});
    Scan scan;
    scan.t = t;
    scan.angle_increment = 0.1;
    for (std::int64_t beam = 0; beam < 20; ++beam)
      scan.ranges.push_back(static_cast<float>(1.0 + 1e-4 * static_cast<double>(count + beam)));
    recording.scans.push_back(scan);
    if (later <= 0.0) continue;
    scan.t += later;
    recording.scans.push_back(scan);
  }
  return recording;
}

TEST(RepeatedScans, are_left_out_where_each_comes_again_within_milliseconds) {
  const auto once = without_repeated_scans(scans_twice(1e-3, 0));
  ASSERT_TRUE(once);
  EXPECT_EQ(once->scans.size(), 30U);
  EXPECT_EQ(once->scans[1].t, 0.1) << "the first of both stays";
  EXPECT_TRUE(without_repeated_scans(scans_twice(1e-3, 30))) << "a rest changes nothing";
  EXPECT_FALSE(without_repeated_scans(scans_twice(0.0, 8))) << "a lidar without noise, at rest";
  EXPECT_FALSE(without_repeated_scans(scans_twice(1e-3, 1))) << "at rest all the time";
}

/// Scans and poses every 0.1 s; the poses begin and end somewhere between.
Recording with_poses(int scans, int poses) {
  Recording recording;
  recording.scans.resize(static_cast<std::size_t>(scans));
  for (int k = 0; k < scans; ++k) recording.scans[static_cast<std::size_t>(k)].t = 0.1 * k;
  for (int k = 0; k < poses; ++k) recording.poses.push_back({0.1 * k, 0.01 * k, 0.0, 0.0});
  return recording;
}

TEST(UnusedScans, are_told_where_poses_cover_less_of_the_drive) {
  const auto told = with_unused_scans_told(with_poses(60, 8));
  ASSERT_TRUE(told);
  ASSERT_EQ(told->repairs.size(), 1U);
  EXPECT_EQ(told->repairs[0].chosen, "8 poses");
  EXPECT_EQ(told->repairs[0].reason,
            "60 scans are not used: the poses are the reference, and cover 0.7 of 5.9 s");
  EXPECT_EQ(told->scans.size(), 60U);
  const Recording given = with_poses(60, 1);
  EXPECT_EQ(put_right({&given, 1})[0].repairs.size(), 1U) << "a single one covers nothing";
}

TEST(UnusedScans, are_not_told_where_nothing_is_lost_with_them) {
  EXPECT_TRUE(word_on_unused_scans(with_poses(101, 80)));
  EXPECT_FALSE(word_on_unused_scans(with_poses(101, 82))) << "80 % of the time and more";
  EXPECT_FALSE(word_on_unused_scans(with_poses(101, 500)));
  EXPECT_FALSE(word_on_unused_scans(with_poses(60, 0))) << "the scans are the reference";
  EXPECT_FALSE(word_on_unused_scans(with_poses(0, 8)));
  EXPECT_FALSE(word_on_unused_scans(with_poses(1, 8))) << "one scan shows no motion";
}

TEST(UnusedScans, are_told_where_the_poses_pause) {
  Recording recording = with_poses(101, 101);
  std::erase_if(recording.poses, [](const PoseSample& pose) { return pose.t > 2.05 && pose.t < 7.95; });
  const auto word = word_on_unused_scans(recording);
  ASSERT_TRUE(word);
  EXPECT_NE(word->find("cover 4.0 of 10.0 s"), std::string::npos) << *word;
}

/// Poses every 0.1 s from `before` on, and from `after` on.
std::string told_of_clock(double before, double after) {
  Recording recording;
  for (int k = 0; k < 20; ++k)
    recording.poses.push_back({(k < 10 ? before : after) + 0.1 * k, 0.0, 0.0, 0.0});
  const auto error = clock_was_set(recording, Form::pose);
  return error ? error->what : "";
}

// A date is one from 1e9 s on, the year 2001.
TEST(ClockWasSet, tells_a_clock_that_counted_since_it_was_switched_on_from_one_that_showed_a_date) {
  constexpr const char* kSinceBoot = "counted since it was switched on";
  EXPECT_NE(told_of_clock(100.0, 1.7e9).find(kSinceBoot), std::string::npos);
  EXPECT_NE(told_of_clock(100.0, 1.0e9 + 1.0).find(kSinceBoot), std::string::npos);
  EXPECT_NE(told_of_clock(0.99e9, 1.01e9).find(kSinceBoot), std::string::npos);
  for (const auto& [before, after] : {std::pair{100.0, 0.99e9}, std::pair{1.01e9, 1.7e9}}) {
    const std::string told = told_of_clock(before, after);
    EXPECT_NE(told.find("their clock was set while recording"), std::string::npos) << told;
    EXPECT_EQ(told.find(kSinceBoot), std::string::npos) << told;
  }
  EXPECT_EQ(told_of_clock(100.0, 100.0 + 0.99e6), "") << "less than twelve days";
  EXPECT_NE(told_of_clock(100.0, 100.0 + 1.01e6), "");
}

}  // namespace
}  // namespace odomcalib::calib::ingest::reference_faults_test
