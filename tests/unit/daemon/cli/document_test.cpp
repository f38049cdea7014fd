#include "daemon/cli/document.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "daemon/cli/calibration_document.hpp"
#include "daemon/cli/export_configurations.hpp"
#include "daemon/cli/export_formats.hpp"
#include "daemon/cli/figure_svg.hpp"
#include "daemon/cli/parameter_tables.hpp"
#include "proto/calibration/report_data.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::cli::document_test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

Calibration example() {
  Calibration calibration;
  calibration.robot.left_wheel_diameter = calibration.robot.right_wheel_diameter = 0.15;
  calibration.robot.track_width = 0.4;
  calibration.parameters = {{"left_wheel_diameter", {0.147, 1e-4, "m"}},
                            {"right_wheel_diameter", {0.147, 1e-4, "m"}},
                            {"track_width", {0.4, 2e-4, "m"}}};
  calibration.covariance_order = {"left_wheel_diameter", "right_wheel_diameter", "track_width"};
  calibration.covariance = {{1e-8, 0.9e-8, 0.0}, {0.9e-8, 1e-8, 0.0}, {0.0, 0.0, 4e-8}};
  calibration.verdict = Verdict::accepted;
  calibration.reasons = {"fits <well> & \"truly\""};
  ReportData data;
  data.drive_errors = {{"straight_metre_length", "m", 12, Bounded{0.0204, 0.02, 0.021}, std::nullopt,
                        Bounded{0.0011, 0.0009, 0.0014}, 0.001}};
  data.paths = {{"odometry", {{0.0, 0.0, 0.0}, {1.0, 0.5, 0.1}}},
                {"calibrated", {{0.0, 0.0, 0.0}, {0.9, 0.4, 0.1}}}};
  data.traces = {
      {"backlash", "speed", "m/s", "heading", "rad", 0.9, {{0.1, 0.01, 0.0}}, {{0.1, 0.01, 1e-3, 0, 1e-3}}}};
  data.detectable = {{"backlash", "left_play", "rad", 0.002, 0.02, "reversals"},
                     {"lateral_slip", "kappa", "s", 0.2, 0.01, "arcs at two speeds"},
                     {"carpet", "p_x", "1", std::nullopt, 0.015, "lines on four headings"}};
  store_report_data(data, calibration);
  return calibration;
}

TEST(Report, text_and_page_say_the_same) {
  const Document document = report(example());
  const std::string text = to_text(document);
  const std::string page = to_html(document);
  for (const char* said :
       {"ACCEPTED", "20.40 (20.00..21.00)", "1.10 (0.90..1.40)", "a metre straight: length",
        "a metre read 20.4 mm too long", "0.90", "noise floor"}) {
    EXPECT_THAT(text, HasSubstr(said));
    EXPECT_THAT(page, HasSubstr(said));
  }
}

TEST(Report, says_what_the_drive_was_no_test_of) {
  const std::string text = to_text(report(example()));
  const std::size_t begin = text.find("What this drive is no test of");
  ASSERT_NE(begin, std::string::npos) << text;
  const std::string untested = text.substr(begin, text.find("\n\n", begin) - begin);
  EXPECT_THAT(untested, HasSubstr("a drive that tests it has"));
  EXPECT_THAT(untested, ContainsRegex("lateral slip +arcs at two speeds"));
  EXPECT_THAT(untested, ContainsRegex("carpet +lines on four headings"));
  EXPECT_THAT(untested, Not(HasSubstr("backlash")));
  EXPECT_THAT(text, ContainsRegex("carpet: p x +never "));
  EXPECT_THAT(text, ContainsRegex("backlash: left play +0.115 "));  // 0.002 rad in degrees
}

TEST(Report, page_is_self_contained_and_escaped) {
  const std::string page = to_html(report(example()));
  EXPECT_THAT(page, HasSubstr("fits &lt;well&gt; &amp; &quot;truly&quot;"));
  for (const char* outside : {"http:", "https:", "<script", "src=", "url(", "@import", "<link"})
    EXPECT_THAT(page, Not(HasSubstr(outside)));
  EXPECT_THAT(page, HasSubstr("prefers-color-scheme:dark"));
  EXPECT_THAT(page, HasSubstr("<svg"));
}

TEST(Report, a_file_without_points_still_makes_a_page) {
  Calibration calibration;
  calibration.reasons = {"no data"};
  const std::string page = to_html(report(calibration));
  EXPECT_THAT(page, HasSubstr("REFUSED"));
  EXPECT_THAT(page, Not(HasSubstr("<svg")));
}

TEST(Figure, what_is_not_finite_is_not_drawn) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  Figure figure{"caption", "x", "y", false, {{"", Curve::Style::line, Curve::Tone::after, {}}}};
  EXPECT_EQ(to_svg(figure), "");
  figure.curves[0].points = {{nan, 1.0}, {infinite, 2.0}};
  EXPECT_EQ(to_svg(figure), "");
  figure.curves[0].points = {{0.0, 1.0}, {nan, 1.0}, {1.0, infinite}, {2.0, 3.0}};
  figure.curves[0].errors = {nan, 1.0, 1.0, 0.5};
  const std::string svg = to_svg(figure);
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
}

TEST(Figure, a_single_point_or_a_level_line_has_a_scale) {
  for (const double value : {0.0, 1e-12, -5.0, 1e9}) {
    Figure figure{"", "", "", false, {{"", Curve::Style::dots, Curve::Tone::after, {{value, value}}}}};
    EXPECT_THAT(to_svg(figure), HasSubstr("<path class=\"d a\" d=\"M")) << value;
    figure.equal_scales = true;
    EXPECT_THAT(to_svg(figure), Not(HasSubstr("nan"))) << value;
  }
}

TEST(Figure, axis_marks_are_round_and_inside) {
  for (const double length : {1e-6, 0.3, 1.0, 7.7, 999.0, 1e7}) {
    const auto marks = axis_marks(-0.31 * length, 0.69 * length, 6);
    EXPECT_GE(marks.size(), 2U) << length;
    EXPECT_LE(marks.size(), 13U) << length;
    for (const double mark : marks) {
      EXPECT_GE(mark, -0.31 * length);
      EXPECT_LE(mark, 0.69 * length * (1.0 + 1e-12));
    }
  }
  EXPECT_TRUE(axis_marks(1.0, 1.0, 5).empty());
}

TEST(Export, csv_and_configuration_files) {
  const Calibration calibration = example();
  const auto parameters = value_of(exported(calibration, "parameters"));
  EXPECT_EQ(parameters.substr(0, 64), "name,value,std,unit\nleft_wheel_diameter,0.147,0.0001,m\nright_whe");
  const auto errors = value_of(exported(calibration, "errors"));
  EXPECT_THAT(errors,
              HasSubstr("straight_metre_length,m,0.0204,0.02,0.021,,,,0.0011,0.0009,0.0014,0.001,12"));
  const auto yaml = value_of(exported(calibration, "diff_drive"));
  EXPECT_THAT(yaml, HasSubstr("wheel_radius: 0.0735"));
  EXPECT_THAT(yaml, HasSubstr("left_wheel_radius_multiplier: 1"));
}

Calibration for_export() {
  Calibration calibration = example();
  calibration.robot.robot_id = "r-1";
  calibration.robot.ticks_per_rev = 4096.0;
  calibration.extensions["contact_noise"] =
      R"({"forward":{"value":1e-3},"sideways":{"value":1e-3},"yaw":{"value":5e-3}})";
  calibration.parameters = {{"left_wheel_diameter", {0.1485, 1e-4, "m"}},
                            {"right_wheel_diameter", {0.147, 1e-4, "m"}},
                            {"track_width", {0.41, 2e-4, "m"}},
                            {"lidar_x", {0.12, 1e-3, "m"}},
                            {"lidar_y", {-0.01, 1e-3, "m"}},
                            {"lidar_yaw", {1.5, 1e-3, "rad"}}};
  calibration.data = {{.name = "drive--1.jsonl",
                       .sha256 = "abc",
                       .begin = 1.75e9,
                       .duration = 60.0,
                       .counts = {},
                       .discarded = {},
                       .choices = {}}};
  EffectResult delay;
  delay.name = "time_offset";
  delay.parameters = {{"offset", {0.05, 0.001, "s"}}};
  EffectResult eccentric;
  eccentric.name = "wheel_eccentricity";
  eccentric.parameters = {{"left_cos", {0.012, 0.001, "1"}}, {"left_sin", {0.003, 0.001, "1"}}};
  calibration.effects = {delay, eccentric};
  return calibration;
}

TEST(Export, of_a_configuration_says_where_it_is_from_and_what_it_cannot_hold) {
  for (const char* what : {"toml", "diff_drive", "ros_arduino", "arcos"}) {
    const auto text = value_of(exported(for_export(), what));
    EXPECT_THAT(text, HasSubstr("calibration of r-1 by odomcalib")) << what;
    EXPECT_THAT(text, HasSubstr(", 2025-06-15, sha256 abc")) << what;
    EXPECT_THAT(text, HasSubstr("not held here: wheel_eccentricity.left_cos = 0.012")) << what;
    EXPECT_THAT(text, HasSubstr("not held here: time_offset.offset = 0.05 s")) << what;
  }
  EXPECT_THAT(exported(for_export(), "ros_arduino").value(), HasSubstr("wheel differ by 1.02 %"));
  EXPECT_THAT(exported(for_export(), "diff_drive").value(), Not(HasSubstr("differ by")));
  EXPECT_TRUE(not_held(example(), "diff_drive").empty());
}

TEST(Export, to_other_programs_has_their_numbers) {
  const std::string urdf = exported(for_export(), "urdf").value();
  EXPECT_THAT(urdf, HasSubstr("<origin xyz=\"0.12 -0.01 0\" rpy=\"0 0 1.5\"/>"));
  EXPECT_THAT(urdf, Not(HasSubstr("drive--1"))) << "it would end the comment";
  EXPECT_THAT(urdf, HasSubstr("time_offset"));
  EXPECT_THAT(urdf, Not(HasSubstr("eccentricity"))) << "of the wheels";
  EXPECT_EQ(exported(example(), "urdf").error().code, ErrorCode::format) << "no lidar pose";
  const std::string arduino = exported(for_export(), "ros_arduino").value();
  EXPECT_THAT(arduino, HasSubstr("wheel_diameter: 0.14775\nwheel_track: 0.41\nencoder_resolution: 4096\n"));
  EXPECT_EQ(exported(example(), "ros_arduino").error().code, ErrorCode::format) << "no counts per turn";
  // Diameters 0.15 and 0.15 were right 0.147 and left 0.1485; the track 0.4 is 0.41.
  const std::string arcos = exported(for_export(), "arcos").value();
  EXPECT_THAT(arcos, HasSubstr("TicksMM      * 1.020408\n"));
  EXPECT_THAT(arcos, HasSubstr("RevCount     * 1.045918\n"));
  EXPECT_THAT(arcos, HasSubstr("DriftFactor  + 84\n"));
}

TEST(Export, every_format_is_known_and_others_are_not) {
  for (const auto& format : export_formats()) EXPECT_TRUE(exported(for_export(), format).ok()) << format;
  EXPECT_EQ(exported(example(), "fax").error().code, ErrorCode::usage);
  EXPECT_EQ(exported(Calibration{}, "toml").error().code, ErrorCode::refused);
}

TEST(Report, a_length_that_nobody_stated_has_no_nominal_value) {
  auto calibration = example();
  calibration.robot = {};
  EXPECT_THAT(to_text(describe(calibration)), Not(HasSubstr(" 0.000 ")));
  EXPECT_THAT(to_text(describe(calibration)), HasSubstr("147.000"));
}

TEST(Report, next_is_the_controller_or_for_a_recording_from_elsewhere_the_export) {
  auto calibration = example();
  calibration.data = {{"drive.lcmlog", "", std::nullopt, 60.0, {}, {}, {}}};
  EXPECT_THAT(to_text(describe(calibration)), HasSubstr("odomcalibctl apply"));
  calibration.data.push_back({"drive.bag", "", std::nullopt, 60.0, {}, {}, {"scan: /scan"}});
  EXPECT_THAT(to_text(describe(calibration)), Not(HasSubstr("odomcalibctl apply")));
  EXPECT_THAT(to_text(describe(calibration)), HasSubstr("odomcalibctl export --what diff_drive"));
}

TEST(WriteBack, a_dry_run_says_what_would_be_written_in_place_of_what) {
  const auto result = nlohmann::ordered_json::parse(R"({"outcome":"dry_run",
    "before":{"left_wheel_diameter":0.15,"right_wheel_diameter":0.15,"track_width":0.4},
    "after":{"track_width":0.4033},"parameters":[]})");
  const std::string text = to_text(describe_write_back(result));
  EXPECT_THAT(text, HasSubstr("nothing was written"));
  EXPECT_THAT(text, HasSubstr("400.000 -> 403.300"));
  EXPECT_THAT(text, Not(HasSubstr("150.000"))) << "what stays is not listed";
}

}  // namespace
}  // namespace odomcalib::cli::document_test
