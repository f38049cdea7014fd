#include "daemon/cli/document.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "calib/odometry/uncertainty.hpp"
#include "daemon/cli/answer_documents.hpp"
#include "daemon/cli/calibration_document.hpp"
#include "daemon/cli/export_configurations.hpp"
#include "daemon/cli/export_formats.hpp"
#include "daemon/cli/figure_svg.hpp"
#include "daemon/cli/parameter_tables.hpp"
#include "daemon/cli/report_figures.hpp"
#include "daemon/cli/report_page.hpp"
#include "daemon/cli/report_sections.hpp"
#include "daemon/cli/report_sheets.hpp"
#include "proto/calibration/report_data.hpp"
#include "proto/calibration/scale.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::cli::document_test {
namespace {

using ::testing::ContainsRegex;
using ::testing::ElementsAre;
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
  data.growth = {{0.5, 20, 0.01, std::nullopt, 0.001}, {1.0, 10, 0.02, std::nullopt, 0.0011}};
  data.paths = {{"odometry", {{0.0, 0.0, 0.0}, {1.0, 0.5, 0.1}}},
                {"calibrated", {{0.0, 0.0, 0.0}, {0.9, 0.4, 0.1}}}};
  data.traces = {
      {"backlash", "speed", "m/s", "heading", "rad", 0.9, {{0.1, 0.01, 0.0}}, {{0.1, 0.01, 1e-3, 0, 1e-3}}}};
  data.detectable = {{"backlash", "left_play", "rad", 0.002, 0.02, "reversals"},
                     {"lateral_slip", "k", "s", 0.2, 0.01, "arcs at two speeds"},
                     {"carpet", "p_x", "1", std::nullopt, 0.015, "lines on four headings"}};
  store_report_data(data, calibration);
  return calibration;
}

EffectResult effect_of(const char* name, QuantityList parameters) {
  EffectResult effect;
  effect.name = name;
  effect.parameters = std::move(parameters);
  return effect;
}

TEST(Report, text_and_page_say_the_same) {
  const std::string text = to_text(describe(example()));
  const std::string page = report_page(example());
  for (const char* said :
       {"ACCEPTED", "20.40 (20.00..21.00)", "1.10 (0.90..1.40)", "a metre straight: length",
        "A metre read 20.4 mm too long, now 1.1 mm off.", "0.90", "noise floor", "repeatable to"}) {
    EXPECT_THAT(text, HasSubstr(said));
    EXPECT_THAT(page, HasSubstr(said));
  }
}

/// Part of the page before everything that is folded.
std::string first_screen_of(const std::string& page) { return page.substr(0, page.find("<details>")); }

TEST(Report, first_screen_answers_what_is_asked_first) {
  Calibration calibration = example();
  calibration.robot.robot_id = "carrier-17";
  calibration.settings.emplace().place = "hall 3";
  calibration.driven = Driven{1795947900.0, 1795948191.0};
  const std::string first = first_screen_of(report_page(calibration));
  for (const char* said : {"ACCEPTED", "carrier-17", "hall 3", "driven 2026-11-29, 10:25 to 10:29 UTC",
                           "A metre read 20.4 mm too long", "20.4</span> &rarr; <span class=\"a\">1.1",
                           "fits &lt;well&gt;", "Next: odomcalibctl apply", "distance driven [m]", "147.000"})
    EXPECT_THAT(first, HasSubstr(said));
  EXPECT_THAT(first, Not(HasSubstr("Where the robot was, by odometry"))) << "the drive is folded";
}

TEST(Report, of_a_refusal_promises_no_gain) {
  Calibration calibration = example();
  calibration.verdict = Verdict::refused;
  const std::string first = first_screen_of(report_page(calibration));
  EXPECT_THAT(first, HasSubstr("by the refused values 1.1 mm off"));
  EXPECT_THAT(first, HasSubstr("What was measured, not to be used"));
  EXPECT_THAT(first, Not(HasSubstr("class=\"sizes\"")));
}

TEST(Report, has_one_table_of_what_was_not_found_with_the_drive_that_tests_it) {
  const std::string text = to_text(describe(example()));
  EXPECT_THAT(text, Not(HasSubstr("What this drive is no test of")));
  EXPECT_THAT(text, HasSubstr("No test of lateral slip, which takes arcs at two speeds"));
  EXPECT_THAT(text, HasSubstr("No test of carpet, which takes lines on four headings"));
  EXPECT_THAT(text, Not(HasSubstr("No test of backlash")));
  EXPECT_THAT(
      text, ContainsRegex("lateral slip: by turn rate +200 mm a metre at 1 rad/s +10 mm a metre at 1 rad/s"));
  EXPECT_THAT(text, ContainsRegex("carpet: along x +never +15 mm a metre"));
  EXPECT_THAT(text, ContainsRegex("backlash: left gear +0.115 deg +1.15 deg *\n"));  // 0.002 rad
  const std::string page = report_page(example());
  EXPECT_THAT(page, HasSubstr("way along x of the room, per metre driven on any heading"));
  EXPECT_THAT(page, HasSubstr("No test of carpet, which takes lines on four headings"));
  EXPECT_THAT(text, Not(HasSubstr("kappa")));
}

TEST(Report, says_without_effects_only_where_one_was_found) {
  Calibration calibration = example();
  ReportData data = report_data_of(calibration);
  data.drive_errors[0].geometry = Bounded{0.0012, 0.001, 0.002};  // with a term that is too small to report
  store_report_data(data, calibration);
  calibration.residual.before = calibration.residual.after = std::array{1e-3, 1e-3, 1e-3};
  EXPECT_THAT(to_text(describe(calibration)), Not(HasSubstr("without effects")));
  calibration.effects = {effect_of("backlash", {{"left_play", {0.06, 1e-3, "rad"}}})};
  EXPECT_THAT(to_text(describe(calibration)), HasSubstr("without effects"));
}

TEST(Report, prints_no_interval_of_few_stretches) {
  Calibration calibration = example();
  ReportData data = report_data_of(calibration);
  data.drive_errors[0].stretches = 9;
  store_report_data(data, calibration);
  const std::string text = to_text(describe(calibration));
  EXPECT_THAT(text, HasSubstr("20.40"));
  EXPECT_THAT(text, Not(HasSubstr("20.40 (")));
}

TEST(Report, has_two_deviations_where_the_metre_is_known) {
  Calibration calibration = example();
  EXPECT_THAT(to_text(describe(calibration)), Not(HasSubstr("true to")));
  calibration.scale = {1.0, 0.001, "tape"};
  const std::string text = to_text(describe(calibration));
  EXPECT_THAT(text, HasSubstr("true to (tape)"));
  EXPECT_THAT(text, ContainsRegex("left wheel diameter +150.000 +147.000 +0.200 +0.356 +mm"));
  EXPECT_THAT(value_of(exported(calibration, "parameters")), HasSubstr("0.147,0.0001,m,0.000177"));
}

TEST(Report, without_straights_and_turns_it_says_what_ten_seconds_are_off_by) {
  Calibration calibration = example();
  ReportData data;
  data.drive_errors = {{"open_loop_10s_position", "m", 12, Bounded{0.008, 0.007, 0.009}, std::nullopt,
                        Bounded{0.0022, 0.002, 0.003}, 0.001}};
  store_report_data(data, calibration);
  EXPECT_THAT(to_text(describe(calibration)),
              HasSubstr("After ten seconds odometry was 8.0 mm off, now 2.2 mm off."));
}

TEST(Report, says_effects_in_plain_words) {
  Calibration calibration = example();
  calibration.effects = {
      effect_of("wheel_eccentricity", {{"left_cos", {0.016, 1e-4, "1"}}, {"left_sin", {-0.012, 1e-4, "1"}}}),
      effect_of("encoder_lag", {{"left_less_right", {-0.005, 1e-4, "s"}}})};
  const std::string text = to_text(describe(calibration));
  EXPECT_THAT(text, HasSubstr("left wheel 1.5 mm off centre, 2.0 % of its radius"));
  EXPECT_THAT(text, HasSubstr("counts of the left wheel are 5.0 ms newer than those of the right one"));
  EXPECT_THAT(text, ContainsRegex("wheel eccentricity: left wheel, cosine part +1.600 +0.020 +%"));
}

/// With an eccentric wheel, play in a gear, and a lidar that sits elsewhere.
Calibration with_findings() {
  Calibration calibration = example();
  calibration.robot.robot_id = "carrier-17";
  calibration.robot.lidar_pose = {0.1, 0.0, 0.0};
  for (const auto& [name, value] : {std::pair{"lidar_x", 0.118}, {"lidar_y", 0.0}})
    calibration.parameters.emplace_back(name, Quantity{value, 1e-4, "m"});
  calibration.parameters.emplace_back("lidar_yaw", Quantity{-0.0087, 1e-4, "rad"});
  calibration.effects = {
      effect_of("wheel_eccentricity", {{"left_cos", {0.016, 1e-4, "1"}}, {"left_sin", {0.012, 1e-4, "1"}}}),
      effect_of("backlash", {{"right_play", {0.0524, 1e-4, "rad"}}, {"spread", {0.0, -1.0, "rad"}}})};
  return calibration;
}

TEST(Sheet, says_what_was_found_where_what_to_look_at_and_what_the_software_does) {
  const std::string sheet = mechanics_sheet(with_findings());
  for (const char* said :
       {"What was found on carrier-17", "left wheel 1.5 mm off centre, 2.0 % of its radius",
        "rim, hub and tyre; an encoder disc that is not centred", "play of 3.0 deg in the right gear",
        "gear, key and coupling", "odometry with this calibration corrects it",
        "lidar 18.0 mm further ahead and turned 0.5 degrees further to the right than stated",
        "left wheel 3.0 mm (2.0 %) smaller than stated", "the new value corrects it",
        "Not tested by this drive: lateral slip, carpet.", "<svg class=\"base\""})
    EXPECT_THAT(sheet, HasSubstr(said));
  // One number in the drawing for each row of the table.
  for (const char* number : {">1</text>", ">5</text>"}) EXPECT_THAT(sheet, HasSubstr(number));
  EXPECT_THAT(sheet, Not(HasSubstr(">6</text>")));
  EXPECT_THAT(sheet, Not(HasSubstr("wheels 0"))) << "the track width is as stated";
}

TEST(Sheet, of_a_refusal_promises_no_correction) {
  Calibration calibration = with_findings();
  calibration.verdict = Verdict::refused;
  const std::string sheet = mechanics_sheet(calibration);
  EXPECT_THAT(sheet, HasSubstr("nothing: the calibration is refused"));
  EXPECT_THAT(sheet, Not(HasSubstr("corrects it")));
}

TEST(Sheet, is_drawn_of_a_robot_of_which_nothing_is_known) {
  EXPECT_THAT(mechanics_sheet(Calibration{}), Not(HasSubstr("nan")));
}

TEST(Certificate, has_what_is_filed) {
  Calibration calibration = with_findings();
  SolveSettings& settings = calibration.settings.emplace();
  settings.version = "0.9.9";
  settings.place = "hall 3";
  settings.note = "no load";
  calibration.scale = {1.002, 0.001, "tape"};
  DataUse drive;
  drive.name = "drive.bag";
  drive.sha256 = "5e4d";
  drive.duration = 291.0;
  calibration.data = {drive};
  calibration.driven = Driven{1795947900.0, 1795948191.0};
  const std::string page = certificate(calibration, "cal.json", "f00d");
  for (const char* said : {"carrier-17", "hall 3", "2026-11-29T10:25:00Z to 2026-11-29T10:29:51Z",
                           "drive.bag, 291 s; SHA-256 5e4d", "cal.json; SHA-256 f00d", "odomcalib 0.9.9",
                           "no load", "true to (tape)", "0.355", "1.002 m by a tape", "+-0.2 %",
                           "A metre read 20.4 mm too long, now 1.1 mm off", "20.40 (20.00..21.00)"})
    EXPECT_THAT(page, HasSubstr(said));
}

TEST(Report, shows_figures_that_have_a_label_in_the_units_of_people) {
  const Section section = further_figures_section({{"span of headings", 6.1, "rad"}, {"creep", 0.0015, "m"}});
  EXPECT_THAT(section.table.rows,
              ElementsAre(ElementsAre("span of headings", "350", "deg"), ElementsAre("creep", "1.5", "mm")));
  EXPECT_TRUE(further_figures_section({}).table.head.empty()) << "nothing to say";
}

TEST(Report, page_is_self_contained_and_escaped) {
  const std::string page = report_page(example());
  EXPECT_THAT(page, HasSubstr("fits &lt;well&gt; &amp; &quot;truly&quot;"));
  for (const char* outside : {"http:", "https:", "<script", "src=", "url(", "@import", "<link"})
    EXPECT_THAT(page, Not(HasSubstr(outside)));
  EXPECT_THAT(page, HasSubstr("prefers-color-scheme:dark"));
  EXPECT_THAT(page, HasSubstr("<svg"));
}

TEST(Report, a_file_without_points_still_makes_a_page) {
  Calibration calibration;
  calibration.reasons = {"no data"};
  const std::string page = report_page(calibration);
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
  EXPECT_THAT(parameters,
              ::testing::StartsWith(
                  "name,value,std,unit,std_absolute\nleft_wheel_diameter,0.147,0.0001,m,\nright_whe"));
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
  calibration.contact_noise = ContactNoise{{1e-3, ""}, {1e-3, ""}, {5e-3, ""}};
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
    EXPECT_THAT(text, HasSubstr("calibration of r-1: accepted; exported by odomcalib")) << what;
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
  EXPECT_EQ(exported(example(), "c_header").error().code, ErrorCode::format) << "no counts per turn";
  // Diameters 0.15 and 0.15 were right 0.147 and left 0.1485; the track 0.4 is 0.41.
  const std::string arcos = exported(for_export(), "arcos").value();
  EXPECT_THAT(arcos, HasSubstr("TicksMM      * 1.020408\n"));
  EXPECT_THAT(arcos, HasSubstr("RevCount     * 1.045918\n"));
  EXPECT_THAT(arcos, HasSubstr("DriftFactor  + 84\n"));
}

TEST(Export, of_lengths_alone_says_what_odometry_then_errs_by) {
  ReportData data;
  const auto error = [](const char* name, const char* unit, double without, double with) {
    return DriveError{name, unit, 12, {}, Bounded{without, 0.0, 1.0}, Bounded{with, 0.0, 1.0}, {}};
  };
  data.drive_errors = {error("full_turn_heading", "rad", 0.0593, 0.00087),
                       error("straight_metre_length", "m", 0.0042, 0.0003)};
  Calibration calibration = for_export();
  store_report_data(data, calibration);
  for (const char* what : {"toml", "diff_drive", "ros_arduino", "arcos"}) {
    const std::string text = exported(calibration, what).value();
    EXPECT_THAT(text,
                HasSubstr("without these effects odometry errs by 3.4 degrees a turn and 4.2 mm a metre, "
                          "with them by 0.05 degrees a turn and 0.3 mm a metre: libodomcalib applies them"))
        << what;
  }
  EXPECT_THAT(exported(calibration, "urdf").value(), Not(HasSubstr("without these effects")));
  EXPECT_THAT(exported(calibration, "c_header").value(), Not(HasSubstr("without these effects")))
      << "it has them";
  calibration.effects.resize(1);
  EXPECT_THAT(exported(calibration, "diff_drive").value(), Not(HasSubstr("without these effects")));
}

TEST(Export, of_noise_says_that_odometry_is_taken_to_be_corrected_for_its_effects) {
  Calibration calibration = for_export();
  calibration.contact_noise = calib::odometry::entry_of({0.002, 0.0, 0.01});
  for (const char* what : {"amcl", "robot_localization", "slam_toolbox"}) {
    const std::string text = value_of(exported(calibration, what));
    EXPECT_THAT(text, HasSubstr("# this is the noise of odometry that is corrected for its effects "
                                "(wheel_eccentricity), which are not held here\n"))
        << what;
    EXPECT_THAT(text, HasSubstr("libodomcalib applies them")) << what;
    EXPECT_THAT(text, Not(HasSubstr("time_offset"))) << "of the lidar's clock";
    EXPECT_EQ(not_held(calibration, what).size(), 2U) << "for standard error, too";
  }
  calibration.effects.clear();
  EXPECT_THAT(value_of(exported(calibration, "amcl")), Not(HasSubstr("corrected for")));
}

TEST(Report, says_what_is_lost_where_the_robot_runs_ros2) {
  const auto lines_of = [](Middleware middleware, bool has_effects, Verdict verdict) {
    Calibration calibration = for_export();
    calibration.verdict = verdict;
    if (!has_effects) calibration.effects.resize(1);  // the clock's alone: odometry has none
    calibration.data[0].middleware = middleware;
    return verdict_section(calibration).lines;
  };
  const auto told =
      testing::Contains(HasSubstr("controllers of ROS 2 hold lengths alone; without these effects"));
  const auto lines = lines_of(Middleware::ros2, true, Verdict::accepted);
  EXPECT_THAT(lines, told);
  EXPECT_THAT(lines, testing::Contains(HasSubstr("libodomcalib applies them")));
  EXPECT_THAT(lines.back(), HasSubstr("Next: "));
  EXPECT_THAT(lines_of(Middleware::ros1, true, Verdict::accepted), Not(told));
  EXPECT_THAT(lines_of(Middleware::ros2, false, Verdict::accepted), Not(told));
  EXPECT_THAT(lines_of(Middleware::ros2, true, Verdict::refused), Not(told));
}

TEST(Report, lays_scans_on_each_other) {
  ReportData data;
  data.scans = {{{{2.0, 0.0}, {0.0, 1.0}}, {1.0, 0.0, 0.0}, {1.0, 0.5, 0.5 * M_PI}}};
  Calibration calibration = for_export();
  store_report_data(data, calibration);
  const Figure figure = figure_of_scans(report_data_of(calibration).scans);
  ASSERT_EQ(figure.curves.size(), 2U);
  EXPECT_TRUE(figure.equal_scales);
  EXPECT_EQ(figure.curves[0].tone, Curve::Tone::before);
  EXPECT_NEAR(figure.curves[0].points[0][0], 3.0, 1e-6);
  EXPECT_NEAR(figure.curves[1].points[0][0], 1.0, 1e-5);
  EXPECT_NEAR(figure.curves[1].points[0][1], 2.5, 1e-5);
  EXPECT_NEAR(figure.curves[1].points[1][0], 0.0, 1e-5);
  EXPECT_THAT(path_section(report_data_of(calibration)).lines,
              testing::Contains(HasSubstr("1 scans of 20 s")));
}

TEST(Export, leaves_out_what_was_not_measured) {
  Calibration calibration = for_export();
  calibration.robot.ticks_per_rev = 1048576.0;
  EXPECT_THAT(exported(calibration, "toml").value(), HasSubstr("ticks_per_rev = 1048576")) << "an encoder's";
  EXPECT_THAT(exported(calibration, "c_header").value(), Not(HasSubstr("the recording has no counts")));
  calibration.data[0].choices = {"wheel motion from wheels"};
  const std::string toml = exported(calibration, "toml").value();
  EXPECT_THAT(toml, Not(HasSubstr("ticks_per_rev")));
  EXPECT_THAT(toml, HasSubstr("lidar_pose = [0.12, -0.01, 1.5]"));
  const std::string arduino = exported(calibration, "ros_arduino").value();
  EXPECT_THAT(arduino, Not(HasSubstr("encoder_resolution:")));
  EXPECT_THAT(arduino, HasSubstr("# encoder_resolution and gear_reduction are left out"));
  EXPECT_THAT(exported(calibration, "c_header").value(), HasSubstr("the recording has no counts"));
  // Joint angles on the grid of a stated encoder are its counts.
  calibration.robot.ticks_per_rev = 4096.0;
  EXPECT_THAT(exported(calibration, "ros_arduino").value(), HasSubstr("encoder_resolution: 4096"));
  // Poses of the base itself tell nothing of a lidar.
  calibration.parameters[4].second.std = -1.0;
  EXPECT_THAT(exported(calibration, "toml").value(), Not(HasSubstr("lidar_pose")));
  EXPECT_EQ(exported(calibration, "urdf").error().code, ErrorCode::format);
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

TEST(Status, has_no_row_of_what_there_is_nothing_to_say_of) {
  auto status = nlohmann::ordered_json::parse(R"({"state":"idle","robot":{"robot_id":""},
    "controller":{"state":"enabled","device":"can0","problem":"","supply_voltage":null},
    "lidar":{"stale":"","device":"/dev/ttyUSB0","problem":""},
    "calibrated":false,"last_stop":"","recording_bytes":0})");
  for (const char* row : {"last stop", "robot  ", "in the way", "battery"})
    EXPECT_THAT(to_text(describe_status(status)), Not(HasSubstr(row)));
  status["last_stop"] = "the lease lapsed";
  status["robot"]["robot_id"] = "carrier-17";
  status["obstacle"] = "0.4 m ahead";
  status["controller"]["supply_voltage"] = 25.93;
  const std::string text = to_text(describe_status(status));
  for (const char* row : {"last stop   the lease lapsed", "robot       carrier-17", "in the way  0.4 m ahead",
                          "battery     25.9 V"})
    EXPECT_THAT(text, HasSubstr(row));
}

TEST(Status, says_that_the_controller_does_not_hold_the_calibration) {
  const auto status = nlohmann::ordered_json::parse(R"({"state":"idle","robot":{"robot_id":""},
    "controller":{"state":"enabled","device":"can0","problem":"","supply_voltage":null},
    "lidar":{"stale":"","device":"/dev/ttyUSB0","problem":""},"calibrated":true,"replaced_controller":"",
    "calibration_not_held":"track_width = 0.4 m, not 0.41 m","last_stop":"","recording_bytes":0})");
  EXPECT_THAT(to_text(describe_status(status)),
              HasSubstr("track_width = 0.4 m, not 0.41 m: odomcalibctl check"));
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

TEST(WriteBack, history_says_when_by_whom_and_what_was_proven) {
  const auto bodies = nlohmann::ordered_json::parse(R"([
    {"id":"0002","time":1795953600000000,"action":"rollback","outcome":"committed","user":1000,"user_name":"ada",
     "restores":"0001","proven":true,"before":{"track_width":0.41},"after":{"track_width":0.4}},
    {"id":"0001","time":1795953540000000,"action":"apply","outcome":"committed","user":1001,
     "proven":false,"before":{"track_width":0.4},"after":{"track_width":0.41}}])");
  std::vector<WriteBack> entries;
  for (const auto& body : bodies) entries.push_back(write_back_from(body).value());
  const std::string text = to_text(describe_history(entries), true, 200);
  for (const char* said : {"2026-11-29 12:00", "ada (1000)", "rollback before 0001", "committed, proven",
                           "2026-11-29 11:59", "(1001)", "committed, unproven", "410.000 -> 400.000"})
    EXPECT_THAT(text, HasSubstr(said));
}

TEST(WriteBack, history_says_how_many_it_does_not_understand) {
  EXPECT_THAT(to_text(describe_history({}, 2), true, 200), HasSubstr("2 more of another version"));
  EXPECT_THAT(to_text(describe_history({}), true, 200), Not(HasSubstr("more")));
}

TEST(WriteBack, a_rollback_says_where_it_goes_and_an_apply_what_is_vouched_for) {
  const auto result =
      nlohmann::ordered_json::parse(R"({"outcome":"dry_run","before":{},"after":{},"parameters":[],
    "goes_to":"the values before entry 0003","asks":["robot.id is not configured"]})");
  const std::string text = to_text(describe_write_back(result));
  EXPECT_THAT(text, HasSubstr("goes back to the values before entry 0003"));
  EXPECT_THAT(text, HasSubstr("to be vouched for: robot.id is not configured"));
}

}  // namespace
}  // namespace odomcalib::cli::document_test
