#include "drivers/base/profile/profile.hpp"

#include <gtest/gtest.h>

#include "tests/unit/drivers/test_support.hpp"

namespace odomcalib::drivers::profile_test {
namespace {

const std::string kFolder = "drivers/base/profiles/";

TEST(Profile, those_of_the_package_are_read) {
  const auto sim = value_of(read_profile(kFolder + "sim-dual.toml"));
  EXPECT_EQ(sim.parameters.size(), 3U);
  EXPECT_EQ(sim.ticks_per_rev, 16384.0);
  const auto zlac = value_of(read_profile(kFolder + "zlac8015d.toml"));
  EXPECT_EQ(zlac.right_sign, -1);
  EXPECT_EQ(zlac.heartbeat_unit_ms, 0.5);
  EXPECT_TRUE(zlac.parameters.empty());
  EXPECT_EQ(zlac.watchdog.object, (canopen::ObjectAddress{0x2000, 0}));
}

TEST(Profile, problems_name_the_key_and_what_is_allowed) {
  const std::string good = test::read_text(kFolder + "sim-dual.toml");
  const auto problem = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    const auto read = parse_profile(text, "test.toml");
    EXPECT_FALSE(read.ok()) << to;
    return read.ok() ? std::string() : read.error().text();
  };
  EXPECT_NE(problem("node = 1", "node = 200").find("profile.node"), std::string::npos);
  EXPECT_NE(problem("node = 1", "nodes = 1").find("profile.nodes"), std::string::npos);
  EXPECT_NE(problem("\"6064:01\"", "\"6064:01:02\"").find("index:sub"), std::string::npos);
  EXPECT_NE(problem("counts_per_rev = 16384", "counts_per_rev = -1").find("counts_per_rev"),
            std::string::npos);
  EXPECT_NE(problem("counts_per_rev = 16384", "counts_per_rev = nan").find("counts_per_rev"),
            std::string::npos);
  EXPECT_NE(problem("kind = \"1016\"", "kind = \"1017\"").find("watchdog.kind"), std::string::npos);
  EXPECT_NE(problem("\"6040:00/16\"", "\"6041:00/16\"").find("mapped nowhere"), std::string::npos);
  EXPECT_NE(problem("\"track_width\"", "\"trackwidth\"").find("quantity"), std::string::npos);
  EXPECT_NE(problem("type = \"u32\"", "type = \"u33\"").find("type"), std::string::npos);
  EXPECT_NE(problem("node = 1", "node = = 1").find("test.toml:"), std::string::npos);
}

// A feed is a way per turn of the motor's shaft unless the profile says of how many; less than one is none.
TEST(Profile, a_feed_is_one_of_one_turn_or_more) {
  const std::string good = test::read_text(kFolder + "sim-dual.toml");
  const auto turns_of = [&](const std::string& line) -> std::optional<double> {
    std::string text = good;
    const std::string scale = "scale = ";
    text.insert(text.find(scale, text.find("track_width")), "formula = \"feed\"\n" + line);
    const auto read = parse_profile(text, "test.toml");
    if (!read) return std::nullopt;
    for (const ProfileParameter& one : read.value().parameters)
      if (one.feed) return one.turns;
    return std::nullopt;
  };
  EXPECT_EQ(turns_of(""), 1.0);
  EXPECT_EQ(turns_of("turns = 1.0\n"), 1.0);
  EXPECT_EQ(turns_of("turns = 1.01\n"), 1.01);
  EXPECT_FALSE(turns_of("turns = 0.99\n"));
}

TEST(Profile, no_damaged_file_passes_the_border_as_an_exception) {
  const std::string good = test::read_text(kFolder + "sim-dual.toml");
  auto random = test::seeded(8);
  for (std::size_t length = 0; length < good.size(); ++length)
    (void)parse_profile(good.substr(0, length), "cut");
  for (int i = 0; i < 1000; ++i) {
    std::string text = good;
    for (int k = 0; k < 3; ++k) text[random() % text.size()] = static_cast<char>(random() & 0xFF);
    (void)parse_profile(text, "damaged");
  }
  SUCCEED();
}

TEST(Profile, parameters_convert_there_and_back_within_half_a_step) {
  ProfileParameter length;
  length.scale = 1e-6;
  length.max = 10'000'000;
  ProfileParameter feed = length;
  feed.feed = true;
  feed.turns = 100;
  feed.max = 4'000'000'000;
  for (const ProfileParameter& parameter : {length, feed})
    for (double value = 0.05; value < 0.6; value += 0.00123457) {
      const auto raw = parameter.to_raw(value);
      ASSERT_TRUE(raw);
      EXPECT_NEAR(parameter.to_si(*raw), value, 0.5001 * parameter.step());
    }
  EXPECT_FALSE(length.to_raw(100.0));
}

}  // namespace
}  // namespace odomcalib::drivers::profile_test
