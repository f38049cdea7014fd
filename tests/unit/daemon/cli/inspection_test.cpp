#include "daemon/cli/inspection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/temporary_folder.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::cli::inspection_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kRobot =
    R"({"type":"robot","wheel_diameter":0.15,"track_width":0.4,"ticks_per_rev":4096})";

/// A straight line, forward: ten counts a second, a scan of four beams a second, one of them without a
/// reading.
std::string drive(const std::string& robot, double zero = 0.0) {
  std::string text = robot.empty() ? "" : robot + "\n";
  for (int k = 0; k <= 100; ++k) {
    text += R"({"type":"ticks","t":)" + std::to_string(zero + 0.1 * k) + R"(,"left":)" +
            std::to_string(174 * k) + R"(,"right":)" + std::to_string(174 * k) + "}\n";
    if (k % 10 == 0 && k != 50)
      text += R"({"type":"scan","t":)" + std::to_string(zero + 0.1 * k) +
              R"(,"angle_min":0,"angle_increment":0.5,"range_min":0.1,"range_max":12,"ranges":[1,2,)" +
              std::to_string(3.0 - 0.01 * k) + ",null]}\n";
  }
  return text;
}

class Inspect : public testing::Test {
 protected:
  Result<Inspection> look(const std::string& content, const RecordingOptions& options = {}) {
    const auto path = folder_ / "drive.jsonl";
    std::ofstream(path) << content;
    return inspect(path.string(), options);
  }
  TemporaryFolder folder_;
};

TEST_F(Inspect, tells_rates_gaps_beams_and_readings) {
  const Inspection found = value_of(look(drive(kRobot)));
  EXPECT_EQ(found.overview.form, "JSON Lines");
  ASSERT_EQ(found.streams.size(), 2U);
  EXPECT_EQ(found.streams[0].name, "ticks");
  EXPECT_NEAR(found.streams[0].rate(), 10.0, 1e-6);
  EXPECT_NEAR(found.streams[0].longest_gap, 0.1, 1e-6);
  EXPECT_EQ(found.streams[1].samples, 10U);
  EXPECT_NEAR(found.streams[1].longest_gap, 2.0, 1e-6) << "a scan is missing";
  ASSERT_TRUE(found.scans);
  EXPECT_EQ(found.scans->most_beams, 4U);
  EXPECT_NEAR(found.scans->share_read, 0.75, 1e-9);
  EXPECT_NEAR(found.scans->field_of_view, 1.5, 1e-6);
  EXPECT_FALSE(found.scans->states_times);
  const std::string told = to_text(describe(found));
  EXPECT_THAT(told, HasSubstr("without a date"));
  EXPECT_THAT(told, HasSubstr("75 % of the beams have a reading"));
  EXPECT_THAT(to_text(describe(value_of(look(drive(kRobot, 1.7e9))))),
              HasSubstr("begun 2023-11-14T22:13:20Z"));
}

TEST_F(Inspect, counts_motion_and_says_what_is_missing) {
  const Inspection found = value_of(look(drive(kRobot)));
  ASSERT_TRUE(found.motion);
  EXPECT_NEAR(found.motion->kinds.forward.amount, 2.0, 0.16);
  const auto told = to_json(found);
  EXPECT_EQ(told["supply"][0]["supply"], "little") << "forward alone";
  EXPECT_EQ(told["supply"][1]["parameters"], "track_width");
  EXPECT_EQ(told["supply"][1]["supply"], "missing");
  EXPECT_THAT(to_text(describe(found)), HasSubstr("drive what is missing"));
}

TEST_F(Inspect, says_at_what_solve_would_stop) {
  const Inspection bare = value_of(look(drive("")));
  ASSERT_TRUE(bare.error);
  EXPECT_EQ(bare.error->code, ErrorCode::missing_units);
  EXPECT_FALSE(bare.motion) << "what a count is nobody can guess";
  EXPECT_THAT(bare.assumed, testing::Contains("ticks_per_rev"));
  EXPECT_THAT(to_text(describe(bare)), HasSubstr("nothing as it stands"));
  std::string counts = kRobot;
  const Inspection unscanned =
      value_of(look(counts + "\n{\"type\":\"ticks\",\"t\":0,\"left\":0,\"right\":0}\n"
                             "{\"type\":\"ticks\",\"t\":1,\"left\":9,\"right\":9}\n"));
  ASSERT_TRUE(unscanned.error);
  EXPECT_THAT(unscanned.error->text(), HasSubstr("neither scans nor reference poses"));
  EXPECT_THAT(to_text(describe(unscanned)), HasSubstr("nothing to compare the wheels with"));
}

TEST_F(Inspect, assumes_usual_lengths_to_count_angles_of_wheels) {
  std::string text;
  for (int k = 0; k <= 100; ++k)
    text += R"({"type":"wheels","t":)" + std::to_string(0.1 * k) + R"(,"left":)" + std::to_string(0.3 * k) +
            R"(,"right":)" + std::to_string(0.3 * k) + "}\n";
  const Inspection found = value_of(look(text));
  ASSERT_TRUE(found.motion);
  EXPECT_THAT(found.assumed,
              testing::ElementsAre("left_wheel_diameter", "right_wheel_diameter", "track_width"));
  EXPECT_GT(found.motion->kinds.forward.amount, 2.0);
  EXPECT_THAT(to_text(describe(found)), HasSubstr("usual values were assumed"));
  std::ofstream(folder_ / "robot.toml") << "wheel_diameter = 0.2\ntrack_width = 0.5\n";
  RecordingOptions options;
  options.robot_file = (folder_ / "robot.toml").string();
  const Inspection known = value_of(look(text, options));
  EXPECT_TRUE(known.assumed.empty());
  EXPECT_NEAR(known.motion->kinds.forward.amount, found.motion->kinds.forward.amount * 0.2 / 0.15, 0.2);
}

TEST_F(Inspect, of_what_is_no_recording_is_an_error) {
  EXPECT_EQ(look("words\n").error().code, ErrorCode::format);
  EXPECT_EQ(look("").error().code, ErrorCode::empty);
  EXPECT_EQ(inspect((folder_ / "absent").string(), {}).error().code, ErrorCode::io);
  RecordingOptions wrong;
  wrong.topics = {"nonsense"};
  EXPECT_EQ(look(drive(kRobot), wrong).error().code, ErrorCode::usage);
}

TEST_F(Inspect, fits_a_terminal_of_eighty_columns) {
  std::istringstream lines(to_text(describe(value_of(look(drive(kRobot)))), true, 80));
  std::string first;
  std::getline(lines, first);  // a path may be longer
  for (std::string line; std::getline(lines, line);) {
    const bool names_file = line.find(folder_.path().string()) != std::string::npos;
    EXPECT_TRUE(names_file || line.size() <= 80U) << line;
  }
}

}  // namespace
}  // namespace odomcalib::cli::inspection_test
