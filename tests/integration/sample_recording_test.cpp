// Result of the program on the sample recording that it ships, as the README says to try it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/wait.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "proto/file_bytes.hpp"

namespace odomcalib::test_support::sample_recording_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;

const char* const kEstimators[] = {"straight", "spin", "linear", "joint_closed_form", "joint"};

/// Solved once for all tests of this file, into a folder that ends with them.
class SampleRecording : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::string name = "/tmp/odomcalib-sr-XXXXXX";
    folder() = mkdtemp(name.data());
    solve("first");
  }
  static void TearDownTestSuite() { fs::remove_all(folder()); }

  static fs::path& folder() {
    static fs::path path;
    return path;
  }
  static void solve(const std::string& name) {
    const std::string command =
        "cd '" + folder().string() +
        "' && COLUMNS=160 '" ODOMCALIB_CTL "' --verbose solve '" ODOMCALIB_SAMPLE "' --out " + name +
        ".json --report " + name + ".html --pairs " + name + ".csv > " + name + ".txt 2> " + name + ".err";
    ASSERT_EQ(WEXITSTATUS(system(command.c_str())), 0) << read(name + ".err");
  }
  static std::string read(const std::string& name) {
    const auto bytes = read_file_bytes(folder() / name);
    return bytes ? bytes.value() : "";
  }
  static json calibration() { return json::parse(read("first.json")); }
};

TEST_F(SampleRecording, S3_16_is_calibrated_by_one_command) {
  EXPECT_THAT(read("first.txt"), ::testing::StartsWith("ACCEPTED"));
}

TEST_F(SampleRecording, S0_20_twice_gives_the_same_bytes) {
  solve("second");
  EXPECT_EQ(read("first.json"), read("second.json"));
  EXPECT_EQ(read("first.txt"), read("second.txt"));
  EXPECT_EQ(read("first.html"), read("second.html"));
}

TEST_F(SampleRecording, S0_23_shows_the_matrix_in_text_and_json_and_what_it_changes_in_numbers) {
  const json matrix = calibration()["linear_correction"]["matrix"];
  ASSERT_EQ(matrix.size(), 3U);
  std::string text = read("first.txt");
  for (const auto& row : matrix)
    for (const auto& element : row) {
      std::array<char, 32> shown{};
      (void)snprintf(shown.data(), shown.size(), "%.5f", element.get<double>());
      EXPECT_THAT(text, HasSubstr(shown.data()));
    }
  EXPECT_THAT(text, ContainsRegex("a full turn: heading +deg +[0-9]"));
  EXPECT_THAT(text, ContainsRegex("10 s without reference: position +mm +[0-9]"));
}

TEST_F(SampleRecording, S0_08_exports_the_measured_motions_with_their_times) {
  std::istringstream lines(read("first.csv"));
  std::string line;
  ASSERT_TRUE(std::getline(lines, line));
  EXPECT_EQ(line,
            "recording,begin,end,odometry_x,odometry_y,odometry_yaw,reference_x,reference_y,reference_yaw");
  std::size_t count = 0;
  for (; std::getline(lines, line); ++count) {
    std::array<double, 8> v{};
    std::istringstream fields(line.substr(line.find(',') + 1));
    char comma = 0;
    for (double& value : v) fields >> value >> comma;
    EXPECT_LT(v[0], v[1]) << line;
    EXPECT_NEAR(v[2], v[5], 0.03) << line;
    EXPECT_NEAR(v[4], v[7], 0.05) << line;
  }
  EXPECT_EQ(count, calibration()["data"][0]["counts"]["pairs"].get<std::size_t>());
}

TEST_F(SampleRecording, S1_09_states_how_far_lidar_and_wheels_err_side_by_side) {
  EXPECT_THAT(read("first.txt"), HasSubstr("reference std"));
  const auto axes = calibration()["picture"]["axes"];
  ASSERT_EQ(axes.size(), 3U);
  for (const auto& axis : axes) {
    EXPECT_GT(axis["reference_std"].get<double>(), 0.0) << axis;
    EXPECT_GE(axis["wheels_std"].get<double>(), 0.0) << axis;
  }
  EXPECT_GT(axes[2]["wheels_std"].get<double>(), 0.0) << "what wheels and floor do shows in yaw first";
}

TEST_F(SampleRecording, S0_19_SD_06_draws_three_labelled_paths_in_one_frame) {
  const std::string page = read("first.html");
  const auto caption = page.find("Where the robot was");
  const auto begin = page.rfind("<svg class=\"map\"", caption), end = page.find("</svg>", begin);
  ASSERT_NE(begin, std::string::npos);
  ASSERT_NE(end, std::string::npos);
  const std::string drawing = page.substr(begin, end - begin);
  for (const char* label : {"odometry", "calibrated", "reference"}) EXPECT_THAT(drawing, HasSubstr(label));
  const json paths = calibration()["picture"]["paths"];
  ASSERT_EQ(paths.size(), 3U);
  // The reference begins with the first scan, when the robot may have gone some tenths of a millimetre.
  for (const auto& path : paths)
    for (const std::size_t axis : {0U, 1U})
      EXPECT_NEAR(path["points"][0][axis].get<double>(), 0.0, 1e-3) << path["name"];
}

TEST_F(SampleRecording, SX_01_S3_10_goes_through_all_estimators_and_their_differences_are_told_in_sigmas) {
  const json methods = calibration()["methods"];
  for (const char* name : kEstimators) EXPECT_TRUE(methods.contains(name)) << name;
  const std::string text = read("first.txt");
  EXPECT_THAT(text, HasSubstr("difference from the answer in sigmas"));
  EXPECT_THAT(text, HasSubstr("straight: from straight pieces alone")) << "what it assumes";
  EXPECT_THAT(text, ContainsRegex(
                        "lidar yaw \\[deg\\] +- +- +- +-?[0-9.]+ \\([+-][0-9.]+\\) +-?[0-9.]+ \\([+]0.0\\)"));
}

TEST_F(SampleRecording, S3_18_SD_09_tells_six_values_with_deviations_of_their_own_and_correlations) {
  const json parameters = calibration()["parameters"], residual = calibration()["residual"];
  const std::string text = read("first.txt");
  for (const char* name :
       {"left wheel diameter", "right wheel diameter", "track width", "lidar x", "lidar y", "lidar yaw"}) {
    const std::string unit = std::string(name) == "lidar yaw" ? "deg" : "mm";
    EXPECT_THAT(text,
                ContainsRegex(std::string("  ") + name + " +[0-9.-]+ +[0-9.-]+ +[0-9.]+ +[0-9.]+ +" + unit));
  }
  EXPECT_THAT(text, HasSubstr("correlations"));
  // A deviation of the lidar's place is no residual of its motion: that one is printed as a residual.
  EXPECT_LT(parameters["lidar_x"]["std"].get<double>(),
            0.3 * calibration()["methods"]["joint"]["rms"][0].get<double>());
  EXPECT_THAT(text, HasSubstr("Residual of the final model"));
}

}  // namespace
}  // namespace odomcalib::test_support::sample_recording_test
