#include "calib/report/left_out.hpp"

#include <gtest/gtest.h>

#include "proto/recording/left_out.hpp"

namespace odomcalib::calib::report::left_out_test {
namespace {

Recording with(std::vector<Discarded> discarded) {
  Recording recording;
  recording.name = "a.jsonl";
  recording.ticks = {{100.0, 0, 0}, {101.0, 5, 5}};
  recording.discarded = std::move(discarded);
  return recording;
}

double share_lost(const Recording& recording) {
  const auto losses = losses_of({&recording, 1});
  return losses.empty() ? 0.0 : losses.front().share;
}

TEST(Losses, are_of_each_stream_and_told_by_what_is_most) {
  const Recording recording = with({{"ticks", kUncontinued, 10, 100, 103.2, 171.0},
                                    {"ticks", kMisread, 20, 100},
                                    {"scan", kRepeatedStamp, 25, 100}});
  const auto losses = losses_of({&recording, 1});
  ASSERT_EQ(losses.size(), 2U);
  EXPECT_TRUE(losses[0].of_wheels);
  EXPECT_FALSE(losses[1].of_wheels);
  EXPECT_NEAR(losses[1].share, 0.25, 1e-12);
  EXPECT_NEAR(losses[0].share, 0.3, 1e-12) << "of one stream they add up";
  EXPECT_EQ(losses[0].text, "20 of 100 counts (20 %): count read wrong once");
}

TEST(Losses, are_none_of_what_is_no_part_of_the_drive) {
  EXPECT_EQ(share_lost(with({{"beam", kOutsideLimits, 90, 100}})), 0.0);
  EXPECT_EQ(share_lost(with({{"message", "/rear/scan was not taken", 90, 100}})), 0.0);
  EXPECT_EQ(share_lost(with({{"wheels", std::string("ticks") + kFinerDecides, 100, 100}})), 0.0);
  EXPECT_EQ(share_lost(with({{"odometry", kRepeatedStamp, 90, 100}})), 0.0) << "counts decide";
  EXPECT_EQ(share_lost(with({{"pair", "match: no_overlap", 90, 100}})), 0.0) << "has a rule of its own";
  Recording by_poses = with({{"scan", kRepeatedStamp, 90, 100}});
  EXPECT_GT(share_lost(by_poses), 0.8);
  by_poses.poses = {{}};
  EXPECT_EQ(share_lost(by_poses), 0.0) << "poses are the reference";
}

TEST(Losses, are_not_what_was_sent_twice) {
  Recording recording = with({{"ticks", kRepeatedStamp, 61, 278}});
  EXPECT_NEAR(share_lost(recording), 61.0 / 278.0, 1e-12);
  recording.discarded[0].copies = 61;
  EXPECT_EQ(share_lost(recording), 0.0);
}

TEST(LeftOut, has_the_pairs_too_and_of_several_recordings_the_name) {
  const std::vector<Recording> recordings = {with({{"ticks", kUncontinued, 3, 100, 1.0, 2.0}}), with({})};
  measurement::PairSet set;
  set.pairs.resize(6);
  set.rejected["match: no_overlap"] = 4;
  const auto all = left_out(recordings, std::vector{set, set});
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].what, kInterval);
  EXPECT_EQ(all[0].reason, std::string("a.jsonl: ") + kUncontinued);
  EXPECT_EQ(all[1].what, "pair");
  EXPECT_EQ(all[1].count, 4U);
  EXPECT_EQ(all[1].of, 10U);
  EXPECT_EQ(left_out({recordings.data(), 1}, {}).front().reason, kUncontinued) << "one needs no name";
}

TEST(Repairs, are_those_of_the_recordings_and_of_the_stamps) {
  Recording recording = with({});
  recording.repairs = {{"times", "of reception", "stamps are in whole seconds"}};
  ingest::StampReport stamps;
  stamps.ticks = 0.004;
  const auto all = repairs_of(ingest::Recordings({recording}, stamps));
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].chosen, "of reception");
  EXPECT_EQ(all[1].what, "stamps of the counts");
  EXPECT_NE(all[1].reason.find("4 ms"), std::string::npos) << all[1].reason;
}

}  // namespace
}  // namespace odomcalib::calib::report::left_out_test
