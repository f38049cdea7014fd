// The configuration files (TOML): whatever they hold, a configuration within its bounds or an error with a
// place.
#include "daemon/config/config.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <random>

#include "tests/value_of.hpp"

namespace odomcalib::config_test {
namespace {

const std::string kGood = R"([controller]
device = "slcan:/dev/ttyACM0?bitrate=500000"
profile = "/usr/share/odomcalib/profiles/sim-dual.toml"
[lidar]
device = "serial:/dev/ttyUSB0?baud=230400"
type = "ld06"
pose = [0.10, 0.0, 0.0]
[robot]
id = "r1"
wheel_diameter = 0.150
track_width = 0.400
front = 0.3
width = 0.5
[limits]
speed = 0.2
turn_rate = 0.5
countdown = 3.0
[lcm]
enabled = true
url = "udpm://239.255.76.67:7667?ttl=0"
channel_prefix = "ODOMCALIB_"
[daemon]
state_dir = "/var/lib/odomcalib"
socket = "/run/odomcalib/control"
)";

unsigned seed() {
  const char* given = std::getenv("ODOMCALIB_TEST_SEED");
  const unsigned seed = given != nullptr ? static_cast<unsigned>(std::strtoul(given, nullptr, 10)) : 41;
  std::printf("seed %u\n", seed);
  return seed;
}

void expect_within_bounds(const Config& config) {
  for (const double number : config.lidar_pose) ASSERT_LE(std::abs(number), 6.3);
  const RobotDescription& robot = config.robot;
  for (const double length : {robot.left_wheel_diameter, robot.right_wheel_diameter, robot.track_width})
    ASSERT_TRUE(length == 0.0 || (length >= 1e-3 && length <= 10.0)) << length;
  ASSERT_GT(config.limits.speed, 0.0);
  ASSERT_LE(config.limits.speed, routines::kCaps.speed);
  ASSERT_LE(config.limits.turn_rate, routines::kCaps.turn_rate);
  ASSERT_LE(config.limits.acceleration, routines::kCaps.acceleration);
  ASSERT_GE(config.countdown, 1.0);
  ASSERT_GT(config.footprint.half_width, 0.0);
}

void expect_sound(const std::string& text) {
  const auto config = parse_config(text, "test.toml");
  if (config.ok()) return expect_within_bounds(config.value());
  ASSERT_NE(config.error().text().find("test.toml"), std::string::npos) << config.error().text();
}

TEST(ConfigFile, that_is_good_is_read) {
  const auto config = value_of(parse_config(kGood, "test.toml"));
  EXPECT_EQ(config.robot.track_width, 0.4);
  EXPECT_EQ(config.limits.speed, 0.2);
}

/// kGood with `line` in place of its line of that key, or below [robot] where it has none.
std::string with(const std::string& line) {
  std::string text = kGood;
  const std::string key = line.substr(0, line.find(' ') + 1);
  const std::size_t at = text.find("\n" + key) + 1;
  if (at == 0) return text.replace(text.find("[robot]\n"), 8, "[robot]\n" + line + "\n");
  return text.replace(at, text.find('\n', at) - at, line);
}

// The obstacle stop looks for obstacles where the pose puts what the lidar sees.
TEST(ConfigFile, with_a_pose_or_a_length_in_another_unit_is_refused_with_what_to_write) {
  const auto says = [](const std::string& line, const std::string& words) {
    const auto config = parse_config(with(line), "test.toml");
    ASSERT_FALSE(config.ok()) << line;
    EXPECT_NE(config.error().text().find(words), std::string::npos) << config.error().text();
  };
  says("pose = [100.0, 0.0, 0.0]", "\"lidar.pose\"");
  says("pose = [100.0, 0.0, 0.0]", "x is from -5 to 5 m; 100 looks like mm: write 0.1");
  says("pose = [0.1, -120, 0.0]", "y is from -5 to 5 m; -120 looks like mm: write -0.12");
  says("pose = [0.1, 0.0, 180.0]",
       "yaw is from -6.283185307 to 6.283185307 rad; 180 looks like degrees: write 3.14159");
  says("pose = [0.1, 0.0, 1000.0]", "rad");
  says("front = 300", "\"robot.front\"");
  says("front = 300", "from 0.01 to 5 m; 300 looks like mm: write 0.3");
  says("back = 250", "250 looks like mm: write 0.25");
  says("width = 500", "500 looks like mm: write 0.5");
  says("left_wheel_diameter = 150", "150 looks like mm: write 0.15");
  EXPECT_TRUE(parse_config(with("pose = [-5, 5, -6.28]"), "test.toml").ok());
}

TEST(ConfigFile, gives_a_second_before_a_motion_whatever_it_says) {
  const auto countdown_of = [](const std::string& value) {
    std::string text = kGood;
    text.replace(text.find("countdown = 3.0"), 15, "countdown = " + value);
    const auto config = parse_config(text, "test.toml");
    return config ? config.value().countdown : -1.0;
  };
  EXPECT_EQ(countdown_of("0.0"), 1.0);
  EXPECT_EQ(countdown_of("0.9"), 1.0);
  EXPECT_EQ(countdown_of("1.5"), 1.5);
}

TEST(ConfigFile, with_a_key_in_quotes_that_looks_like_a_path_is_refused) {
  for (const std::string key : {R"("robot.track_width" = 0.4)", R"("" = {robot = {track_width = 0.4}})"}) {
    const auto config = parse_config(key + "\n[robot]\nid = \"a\"\n", "test.toml");
    ASSERT_FALSE(config.ok()) << key;
    EXPECT_NE(config.error().what.find("unknown key"), std::string::npos) << config.error().text();
  }
}

TEST(ConfigFile, cut_off_at_any_byte_is_sound_or_refused) {
  for (std::size_t size = 0; size < kGood.size(); ++size) expect_sound(kGood.substr(0, size));
}

TEST(ConfigFile, with_any_number_out_of_place_is_sound_or_refused) {
  constexpr std::array kWords = {
      "nan",   "-inf",  "inf", "1e999", "-1e308",     "1e-320", "0",  "-0.0",  "-1",
      "true",  "\"x\"", "[1]", "{}",    "1979-05-27", "0x10",   "_1", "1e1_0", "99999999999999999999",
      "0.1.2", ""};
  for (std::size_t at = kGood.find_first_of("0123456789"); at != std::string::npos;
       at = kGood.find_first_of("0123456789", kGood.find_first_not_of("0123456789.", at))) {
    const std::size_t end = kGood.find_first_not_of("0123456789.", at);
    for (const char* word : kWords) {
      SCOPED_TRACE(word);
      expect_sound(kGood.substr(0, at) + word + kGood.substr(end));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(ConfigFile, with_damaged_bytes_is_sound_or_refused) {
  std::mt19937 random(seed());
  for (int i = 0; i < 1500; ++i) {
    std::string text = kGood;
    for (unsigned n = 1 + random() % 4; n > 0; --n)
      text[random() % text.size()] = static_cast<char>(random());
    SCOPED_TRACE(text);
    expect_sound(text);
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace odomcalib::config_test
