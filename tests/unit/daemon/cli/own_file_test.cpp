// Files of the user's own that export changes: the one place that is meant, its values, and nothing else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "daemon/cli/diff_drive_place.hpp"
#include "daemon/cli/lidar_joint_place.hpp"
#include "daemon/cli/text_edit.hpp"
#include "proto/file_bytes.hpp"
#include "tests/temporary_folder.hpp"

namespace odomcalib::cli::own_file_test {
namespace {

using ::testing::HasSubstr;

const std::vector<std::pair<std::string, double>> kValues = {{"wheel_separation", 0.41},
                                                             {"wheel_radius", 0.0735},
                                                             {"wheel_separation_multiplier", 1.0},
                                                             {"left_wheel_radius_multiplier", 1.005},
                                                             {"right_wheel_radius_multiplier", 0.995}};

std::string changed(const std::string& yaml,
                    const std::vector<std::pair<std::string, double>>& values = kValues) {
  const auto edits = diff_drive_edits(yaml, values, "c.yaml");
  return edits ? edited(yaml, edits.value()) : "ERROR " + edits.error().text();
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

constexpr const char* kControllers = R"(# of the robot in hall 3
controller_manager:
  ros__parameters:
    update_rate: 50   # Hz

/**:
  ros__parameters:
    wheel_radius: 0.075        # m, tape measure, März
    left_wheel_names: ["l"]
    wheel_separation: 0.400    # m
    right_wheel_radius_multiplier: 1.0
    left_wheel_radius_multiplier: 1.0
    wheel_separation_multiplier: 1.02
    odom_frame_id: odom
)";

TEST(DiffDriveFile, has_its_numbers_replaced_and_every_other_byte_as_it_was) {
  std::string wanted = kControllers;
  for (const auto& [was, is] :
       {std::pair{"wheel_radius: 0.075 ", "wheel_radius: 0.0735 "},
        {"wheel_separation: 0.400", "wheel_separation: 0.41"},
        {"right_wheel_radius_multiplier: 1.0", "right_wheel_radius_multiplier: 0.995"},
        {"left_wheel_radius_multiplier: 1.0", "left_wheel_radius_multiplier: 1.005"},
        {"separation_multiplier: 1.02", "separation_multiplier: 1.0"}})
    wanted = replaced(wanted, was, is);
  EXPECT_EQ(changed(kControllers), wanted);
  EXPECT_EQ(changed(wanted), wanted) << "a second time";
  // Behind letters of several bytes too, where characters are not bytes.
  EXPECT_EQ(changed("# Räder: \xE2\x82\xAC\n" + std::string(kControllers)),
            "# Räder: \xE2\x82\xAC\n" + wanted);
}

TEST(DiffDriveFile, keeps_how_a_number_is_written_that_is_right) {
  const std::string yaml = "a: {wheel_separation: 4.10e-1, wheel_radius: +0.07350}\n";
  EXPECT_EQ(changed(yaml, {{"wheel_separation", 0.41}, {"wheel_radius", 0.0735}}), yaml);
}

TEST(DiffDriveFile, gets_all_multipliers_that_it_lacks_below_the_radius) {
  EXPECT_EQ(changed("base:\n  wheel_radius: 0.075  # m\n  wheel_separation: 0.4\n"),
            "base:\n  wheel_radius: 0.0735  # m\n  wheel_separation_multiplier: 1.0\n"
            "  left_wheel_radius_multiplier: 1.005\n"
            "  right_wheel_radius_multiplier: 0.995\n  wheel_separation: 0.41\n");
  EXPECT_EQ(changed("base: {wheel_separation: 0.4, wheel_radius: 0.075}"),
            "base: {wheel_separation: 0.41, wheel_radius: 0.0735, wheel_separation_multiplier: 1.0, "
            "left_wheel_radius_multiplier: 1.005, right_wheel_radius_multiplier: 0.995}");
  EXPECT_EQ(changed("wheel_separation: 0.4\r\nwheel_radius: 0.075\r\n"),
            "wheel_separation: 0.41\r\nwheel_radius: 0.0735\r\nwheel_separation_multiplier: 1.0\r\n"
            "left_wheel_radius_multiplier: 1.005\r\nright_wheel_radius_multiplier: 0.995\r\n");
  EXPECT_EQ(changed("wheel_separation: 0.4\nwheel_radius: 0.075"),
            "wheel_separation: 0.41\nwheel_radius: 0.0735\nwheel_separation_multiplier: 1.0\n"
            "left_wheel_radius_multiplier: 1.005\nright_wheel_radius_multiplier: 0.995");
}

/// Parameters of nodes of ROS 2, a line a section.
std::string sections(const std::vector<std::pair<std::string, std::string>>& nodes) {
  std::string yaml;
  for (const auto& [node, parameters] : nodes)
    yaml.append(node).append(":\n  ros__parameters: {").append(parameters).append("}\n");
  return yaml;
}

constexpr const char* kLengths = "wheel_separation: 0.4, wheel_radius: 0.075";
constexpr const char* kFactor = "wheel_separation_multiplier: 1.07";

TEST(DiffDriveFile, whose_multipliers_another_section_may_give_is_refused_with_line_and_value) {
  const std::string told =
      "c.yaml:4: wheel_separation_multiplier: 1.07 stands beside the parameters that change, and may apply "
      "to the same controller; remove it, or make it 1.0; nothing was written";
  for (const char* node : {"/**", "/*", "/**/base", "/base", "base", "'*'"})
    EXPECT_THAT(changed(sections({{"base", kLengths}, {node, kFactor}})), HasSubstr(told)) << node;
  EXPECT_THAT(changed(sections({{"/**", kLengths}, {"base", kFactor}})), HasSubstr(told))
      << "with wildcards nobody knows which nodes are meant";
  EXPECT_THAT(changed(sections({{"base", kFactor}, {"/**", kLengths}})), HasSubstr("c.yaml:2: wheel_sep"));
  EXPECT_THAT(changed(sections({{"base", kLengths}, {"/**", "wheel_radius: 0.08"}})),
              HasSubstr("c.yaml:4: wheel_radius: 0.08"));
  EXPECT_THAT(changed(sections({{"base", kLengths}, {"/**", "left_wheel_radius_multiplier: $(var l)"}})),
              HasSubstr("$(var l)"));
  EXPECT_THAT(
      changed("base:\n  wheel_separation: 0.4\n  wheel_radius: 0.1\nbase:\n  " + std::string(kFactor)),
      HasSubstr("c.yaml:5: "));
  EXPECT_THAT(
      changed("m: &m {" + std::string(kFactor) + "}\n" + sections({{"base", kLengths}, {"/**", "<<: *m"}})),
      HasSubstr("c.yaml:1: wheel_separation_multiplier: 1.07"));
}

TEST(DiffDriveFile, has_its_own_values_over_those_of_a_section_with_wildcards_above) {
  const std::string own =
      "wheel_separation: 0.41, wheel_radius: 0.0735, wheel_separation_multiplier: 1.0, "
      "left_wheel_radius_multiplier: 1.005, right_wheel_radius_multiplier: 0.995";
  EXPECT_EQ(changed(sections({{"/**", kFactor}, {"base", kLengths}})),
            sections({{"/**", kFactor}, {"base", own}}));
  for (const char* node : {"other", "/robot2/base", "/robot2/*"})
    EXPECT_EQ(changed(sections({{"base", kLengths}, {node, kFactor}})),
              sections({{"base", own}, {node, kFactor}}))
        << "of another node: " << node;
  const char* same = "wheel_separation_multiplier: 1.00";
  EXPECT_EQ(changed(sections({{"base", kLengths}, {"/**", same}})), sections({{"base", own}, {"/**", same}}));
}

TEST(DiffDriveFile, with_one_multiplier_for_both_wheels_is_refused_unless_it_is_one) {
  const std::string yaml =
      "base:\n  wheel_separation: 0.4\n  wheel_radius_multiplier: 1.03\n  wheel_radius: 0.1\n";
  EXPECT_THAT(changed(yaml),
              HasSubstr("c.yaml:3: wheel_radius_multiplier: 1.03 stands beside the parameters"));
  EXPECT_THAT(changed(yaml), HasSubstr("remove it or make it 1.0"));
  EXPECT_EQ(changed(replaced(yaml, "1.03", "1.0")).find("ERROR"), std::string::npos);
  EXPECT_THAT(changed(sections({{"/**", "wheel_radius_multiplier: 1.03"}, {"base", kLengths}})),
              HasSubstr("c.yaml:2: wheel_radius_multiplier: 1.03"));
}

TEST(DiffDriveFile, without_one_place_is_refused_with_the_lines) {
  EXPECT_THAT(changed("a:\n  wheel_radius: 0.1\nb:\n  wheel_separation: 0.4\n"),
              HasSubstr("no place has both wheel_separation (in line 4) and wheel_radius (in line 2)"));
  EXPECT_THAT(changed("# wheel_radius: 0.1\n"), HasSubstr("wheel_separation (nowhere)"));
  const std::string twice =
      "a: {wheel_radius: 0.1, wheel_separation: 0.4}\nb:\n  - wheel_radius: 0.1\n"
      "    wheel_separation: 0.4\n";
  EXPECT_THAT(changed(twice), HasSubstr("2 places have wheel_separation and wheel_radius: lines 1, 3"));
  EXPECT_THAT(changed("wheel_radius: 0.1\nwheel_separation: 0.4\nwheel_radius: 0.2\n"),
              HasSubstr("c.yaml:3: wheel_radius stands there a second time, first in line 1"));
  EXPECT_THAT(changed("wheel_radius: [0.1\n"), HasSubstr("is no YAML"));
}

TEST(DiffDriveFile, with_values_that_are_no_plain_numbers_is_refused_by_name) {
  const auto with = [](const std::string& radius) {
    return changed("r: &r 0.1\nwheel_separation: 0.4\nwheel_radius: " + radius + "\n");
  };
  EXPECT_THAT(with("$(var radius)"),
              HasSubstr("c.yaml:3: wheel_radius is an expression ($(var radius)); make it 0.0735 by hand"));
  EXPECT_THAT(with("\"${radius}\""), HasSubstr("is an expression"));
  EXPECT_THAT(with("*r"), HasSubstr("refers to another place (*r)"));
  EXPECT_THAT(with("&own 0.1"), HasSubstr("other places may refer to"));
  for (const char* text : {"\"0.1\"", "0.1 m", "0,1", "!degrees 0.1", ".nan", "[0.1]", ""})
    EXPECT_THAT(with(text), HasSubstr("c.yaml:3: wheel_radius is no number")) << text;
  EXPECT_EQ(with(" 0.1").find("ERROR"), std::string::npos);
}

TEST(DiffDriveFile, whose_parameters_are_shared_is_refused) {
  EXPECT_THAT(changed("a: &a\n  wheel_separation: 0.4\n  wheel_radius: 0.1\nb: *a\n"),
              HasSubstr("shared with another"));
  EXPECT_THAT(changed("d: &d {x: 1}\na:\n  <<: *d\n  wheel_separation: 0.4\n  wheel_radius: 0.1\n"),
              HasSubstr("c.yaml:3: these parameters are shared with another"));
}

std::string moved(const std::string& urdf, const std::string& link = "",
                  const LidarPlace& place = {0.12, -0.01, 1.5}) {
  const auto edits = lidar_joint_edits(urdf, place, link, "r.urdf");
  return edits ? edited(urdf, edits.value()) : "ERROR " + edits.error().text();
}

constexpr const char* kRobot = R"(<?xml version="1.0"?>
<robot name="r">
  <!-- <joint name="old" type="fixed"><parent link="base_link"/><child link="laser"/><origin xyz="0 0 0"/></joint> -->
  <joint name="wheel" type="continuous"><parent link="base_link"/><child link="wheel_left"/></joint>
  <joint name="scanner" type="fixed">
    <parent link="base_link"/>
    <child link="base_scan"/>
    <origin rpy='0.01 0  0.0'
            xyz="0.10 0.0 0.182"/>  <!-- z by tape -->
  </joint>
  <transmission name="t"><joint name="wheel"/></transmission>
</robot>
)";

TEST(UrdfFile, has_the_place_of_its_lidar_replaced_and_every_other_byte_as_it_was) {
  const std::string wanted =
      replaced(replaced(kRobot, "0.01 0  0.0'", "0.01 0  1.5'"), "0.10 0.0 0.182", "0.12 -0.01 0.182");
  EXPECT_EQ(moved(kRobot), wanted);
  EXPECT_EQ(moved(kRobot, "base_scan"), wanted);
  EXPECT_EQ(moved(wanted), wanted) << "a second time";
}

TEST(UrdfFile, gets_the_attributes_that_its_origin_lacks) {
  const std::string given = replaced(kRobot, "0.10 0.0 0.182", "0.12 -0.01 0.182");
  EXPECT_EQ(moved(replaced(kRobot, "rpy='0.01 0  0.0'", "")),
            replaced(given, "rpy='0.01 0  0.0'", "rpy=\"0 0 1.5\" "));
  const std::string origin = "<origin rpy='0.01 0  0.0'\n            xyz=\"0.10 0.0 0.182\"/>";
  EXPECT_THAT(moved(replaced(kRobot, origin, "<origin/>")),
              HasSubstr("<origin xyz=\"0.12 -0.01 0\" rpy=\"0 0 1.5\"/>"));
}

TEST(UrdfFile, without_one_joint_of_the_lidar_is_refused_with_the_lines) {
  EXPECT_THAT(moved(replaced(kRobot, "base_scan", "velodyne")),
              HasSubstr("no joint holds a link with laser, lidar or scan in its name; links on joints: "
                        "wheel_left, velodyne"));
  EXPECT_EQ(moved(replaced(kRobot, "base_scan", "velodyne"), "velodyne").find("ERROR"), std::string::npos);
  EXPECT_THAT(moved(kRobot, "laser"), HasSubstr("no joint holds \"laser\""));
  const std::string two = replaced(kRobot, "wheel_left", "Rear_Lidar");
  EXPECT_THAT(moved(two), HasSubstr("2 joints may hold the lidar: lines 4 (Rear_Lidar), 5 (base_scan)"));
  EXPECT_EQ(moved(two, "base_scan").find("ERROR"), std::string::npos);
  EXPECT_THAT(moved(replaced(kRobot, "wheel_left", "base_scan"), "base_scan"),
              HasSubstr("lines 4 (base_scan), 5 (base_scan)"));
  EXPECT_THAT(moved("<robot>"), HasSubstr("r.urdf:1: is no XML"));
}

TEST(UrdfFile, whose_joint_does_not_state_the_pose_on_the_base_is_refused) {
  EXPECT_THAT(moved(replaced(kRobot, "    <parent link=\"base_link\"/>\n", "    <parent link=\"mast\"/>\n")),
              HasSubstr("r.urdf:5: the joint \"scanner\" holds it on \"mast\""));
  EXPECT_THAT(moved(replaced(kRobot, "\"scanner\" type=\"fixed\"", "\"scanner\" type=\"revolute\"")),
              HasSubstr("is not fixed"));
  const std::string origin = "<origin rpy='0.01 0  0.0'\n            xyz=\"0.10 0.0 0.182\"/>";
  EXPECT_THAT(moved(replaced(kRobot, origin, "")), HasSubstr("has no <origin>"));
  EXPECT_THAT(moved(replaced(kRobot, origin, origin + origin)), HasSubstr("several origins"));
  // Upside down, and leaning by 17 degrees; 14 are level.
  EXPECT_THAT(moved(replaced(kRobot, "'0.01 0  0.0'", "'3.14159 0 0'")),
              HasSubstr("r.urdf:8: the lidar leans or is upside down"));
  EXPECT_THAT(moved(replaced(kRobot, "'0.01 0  0.0'", "'0 0.3 0'")), HasSubstr("leans"));
  EXPECT_EQ(moved(replaced(kRobot, "'0.01 0  0.0'", "'0 0.24 0'")).find("ERROR"), std::string::npos);
}

TEST(UrdfFile, with_expressions_of_xacro_is_refused_by_name) {
  EXPECT_THAT(moved(replaced(kRobot, "0.10 0.0 0.182", "${lidar_x} 0 ${h + 0.1}")),
              HasSubstr("r.urdf:8: xyz is an expression of xacro (${lidar_x} 0 ${h + 0.1})"));
  EXPECT_THAT(moved(replaced(kRobot, "base_scan", "${prefix}base_scan")),
              HasSubstr("made by an expression of xacro"));
  EXPECT_THAT(moved(replaced(kRobot, "0.10 0.0 0.182", "0.1 0")), HasSubstr("is not three numbers"));
  // The text of an entity is not replaced where it is used.
  const std::string entity =
      "<!DOCTYPE robot [<!ENTITY o '<origin xyz=\"0 0 0\"/>'>]>\n<robot><joint name=\"s\" type=\"fixed\">"
      "<parent link=\"base_link\"/><child link=\"laser\"/>&o;</joint></robot>";
  EXPECT_THAT(moved(entity), HasSubstr("has its origin from elsewhere"));
}

TEST(TextEdits, are_shown_as_diff_shows_them) {
  EXPECT_EQ(diff_of("f", "a\nb\nc\n", "a\nB\nc\n"), "--- f~\n+++ f\n@@ -2 +2 @@\n-b\n+B\n");
  EXPECT_EQ(diff_of("f", "a\nb\n", "a\nx\ny\nb\n"), "--- f~\n+++ f\n@@ -1,0 +2,2 @@\n+x\n+y\n");
  EXPECT_EQ(diff_of("f", "a\nb\nc\nd\n", "A\nA2\nb\nc\nD\n"),
            "--- f~\n+++ f\n@@ -1 +1,2 @@\n-a\n+A\n+A2\n@@ -4 +5 @@\n-d\n+D\n");
  EXPECT_EQ(diff_of("f", "a\nb\n", "a\n"), "--- f~\n+++ f\n@@ -2 +1,0 @@\n-b\n");
  EXPECT_EQ(diff_of("f", "a\n", "a\n"), "");
}

TEST(TextEdits, write_numbers_that_stay_real_and_read_back) {
  for (const auto& [number, text] :
       {std::pair{1.0, "1.0"}, {0.41, "0.41"}, {1e-7, "1e-07"}, {-2.0, "-2.0"}}) {
    EXPECT_EQ(real_text(number), text);
    EXPECT_EQ(number_in(real_text(number)), number);
  }
  for (const char* text : {"", "nan", "inf", "1,0", "1.0 ", "1.0m", "++1"})
    EXPECT_FALSE(number_in(text)) << text;
}

class OwnFile : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(path_) << "a: 1\n";
    std::filesystem::permissions(path_, std::filesystem::perms(0640));
  }
  [[nodiscard]] std::string read(const std::string& name) const {
    const auto bytes = read_file_bytes(folder_ / name);
    return bytes ? bytes.value() : "none";
  }

  TemporaryFolder folder_;
  std::string path_ = (folder_ / "c.yaml").string();
  std::vector<TextEdit> edits_ = {{3, 1, "2"}};
};

TEST_F(OwnFile, that_is_changed_is_kept_under_its_name_with_a_tilde_and_keeps_its_mode) {
  ASSERT_TRUE(change_own_file(path_, "a: 1\n", edits_).ok());
  EXPECT_EQ(read("c.yaml"), "a: 2\n");
  EXPECT_EQ(read("c.yaml~"), "a: 1\n");
  for (const char* name : {"c.yaml", "c.yaml~"})
    EXPECT_EQ(std::filesystem::status(folder_ / name).permissions(), std::filesystem::perms(0640)) << name;
}

TEST_F(OwnFile, behind_a_link_is_changed_and_the_link_stays) {
  std::filesystem::create_symlink("c.yaml", folder_ / "link.yaml");
  ASSERT_TRUE(change_own_file((folder_ / "link.yaml").string(), "a: 1\n", edits_).ok());
  EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "link.yaml"));
  EXPECT_EQ(read("c.yaml"), "a: 2\n");
  EXPECT_EQ(read("c.yaml~"), "a: 1\n");
}

TEST_F(OwnFile, that_somebody_else_changed_meanwhile_is_left_alone) {
  const auto done = change_own_file(path_, "a: 0\n", edits_);
  ASSERT_FALSE(done.ok());
  EXPECT_EQ(done.error().code, ErrorCode::busy);
  EXPECT_EQ(read("c.yaml"), "a: 1\n");
  EXPECT_EQ(read("c.yaml~"), "none");
}

TEST_F(OwnFile, that_cannot_be_kept_is_not_changed) {
  std::filesystem::create_directory(folder_ / "c.yaml~");
  EXPECT_FALSE(change_own_file(path_, "a: 1\n", edits_).ok());
  EXPECT_EQ(read("c.yaml"), "a: 1\n");
}

}  // namespace
}  // namespace odomcalib::cli::own_file_test
