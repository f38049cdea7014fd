#include "proto/recording/left_out.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "proto/calibration/discarded_json.hpp"

namespace odomcalib::left_out_test {
namespace {

const Discarded kBroken{kInterval, kUncontinued, 363, 1916, 1003.24, 1071.2};

TEST(LeftOut, is_told_with_its_share_and_its_times_from_the_start) {
  EXPECT_EQ(to_text(kBroken, 1000.0),
            std::string("363 of 1916 intervals between counts (19 %), from 3.2 to 71 s: ") + kUncontinued);
  EXPECT_EQ(to_text({"file", "cut off", 1}, std::nullopt), "1 file: cut off");
  EXPECT_EQ(to_text({"file", "compressed data is cut off", 1, 0, 1071.2, 1071.2}, 1000.0),
            "the file from 71 s on: compressed data is cut off");
  EXPECT_EQ(to_text({"scan", "no ranges", 2, 8, 5.0, 5.0}, 1.0), "2 of 8 scans (25 %), at 4.0 s: no ranges");
  EXPECT_EQ(to_text({"robot", "differs", 1}, std::nullopt), "1 robot: differs") << "a kind without a name";
}

TEST(LeftOut, is_a_loss_where_a_calibration_would_have_used_it) {
  EXPECT_TRUE(is_loss(kBroken));
  EXPECT_TRUE(is_loss_of_motion(kBroken));
  EXPECT_TRUE(is_loss({"scan", kRepeatedStamp, 1, 9}));
  EXPECT_FALSE(is_loss_of_motion({"scan", kRepeatedStamp, 1, 9}));
  EXPECT_FALSE(is_loss({"beam", kOutsideLimits, 5, 9}));
  EXPECT_FALSE(is_loss({"message", "/tf was not taken", 5}));
  EXPECT_FALSE(is_loss({"event", "unknown fingerprint 0x1", 5}));
  EXPECT_TRUE(is_loss({"event", "cut off", 1})) << "nobody knows how much followed";
  EXPECT_FALSE(is_loss_of_motion({"event", "cut off", 1}));
  EXPECT_FALSE(is_loss({"odometry", std::string("ticks") + kFinerDecides, 9, 9}));
  EXPECT_FALSE(is_loss({"wheels", std::string("always 0, 0") + kOfSecondProgram, 9, 20}));
  EXPECT_FALSE(is_loss({"scan", kOfAnotherSensor, 9, 20}));
  Discarded twice{"ticks", kRepeatedStamp, 4, 9};
  twice.copies = 4;
  EXPECT_FALSE(is_loss(twice)) << "what was kept says it";
  twice.count = 5;
  EXPECT_TRUE(is_loss(twice));
  EXPECT_NEAR(share_of(twice), 1.0 / 9.0, 1e-12);
  EXPECT_EQ(to_text(twice, std::nullopt),
            "5 of 9 counts (56 %), 4 of them the same again: repeated time stamp");
}

TEST(LeftOut, as_json_has_null_where_it_has_no_time) {
  EXPECT_EQ(to_json(Discarded{"file", "cut off", 1}).dump(),
            R"({"what":"file","count":1,"of":0,"begin":null,"end":null,"reason":"cut off"})");
  EXPECT_EQ(to_json(kBroken)["begin"], 1003.24);
  EXPECT_EQ(to_json(Repair{"times", "of reception", "why"}).dump(),
            R"({"what":"times","chosen":"of reception","reason":"why"})");
}

}  // namespace
}  // namespace odomcalib::left_out_test
