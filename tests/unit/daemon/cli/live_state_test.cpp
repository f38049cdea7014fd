// State that the live page shows, from answers and messages of the daemon.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "daemon/cli/live/live_page.hpp"
#include "daemon/cli/live/live_state.hpp"
#include "daemon/cli/live/page_server.hpp"
#include "proto/calibration/report_data.hpp"
#include "proto/wire/messages.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::cli::live_state_test {
namespace {

using nlohmann::ordered_json;
using testing::HasSubstr;

ordered_json description(const std::string& url = "memq://") {
  return {{"lcm", {{"url", url}, {"channel_prefix", "P_"}}}, {"lidar", {{"pose", {0.1, 0.0, 0.0}}}}};
}

ordered_json status(const std::string& state, double x = 0.0) {
  return {{"state", state}, {"odometry", {x, 0.0, 0.0}}, {"lidar", {{"stale", ""}}}, {"last_stop", ""}};
}

std::string pose(double x, double y, double yaw) {
  return messages::encode(messages::Stamp{}, PoseSample{0.0, x, y, yaw});
}

Calibration calibration() {
  Calibration calibration;
  calibration.verdict = Verdict::accepted;
  calibration.reasons.clear();
  calibration.robot = {0.15, 0.15, 0.4, 4096.0, std::nullopt, "", ""};
  calibration.parameters = {{"track_width", {0.41, 0.0002, "m"}}};
  ReportData data;
  for (const char* name : {"odometry", "calibrated", "reference"})
    data.paths.push_back({name, {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}});
  store_report_data(data, calibration);
  return calibration;
}

std::string result() { return messages::encode_json(0, "odomcalib-calibration/1", to_json(calibration())); }

TEST(Trace, begins_at_the_origin_wherever_its_source_is) {
  Trace trace;
  trace.restart({});
  trace.add({5.0, 5.0, std::acos(0.0)});
  trace.add({5.0, 6.0, std::acos(0.0)});
  EXPECT_NEAR(trace.now()->x, 1.0, 1e-12);
  EXPECT_NEAR(trace.now()->y, 0.0, 1e-12);
}

TEST(Trace, has_a_bounded_number_of_points_over_its_whole_length) {
  Trace trace;
  trace.restart({Pose{}});
  for (int k = 0; k < 100'000; ++k) trace.add({0.02 * k, 0.0, 0.0});
  EXPECT_LE(trace.points().size(), Trace::kMostPoints);
  EXPECT_GE(trace.points().size(), Trace::kMostPoints / 4);
  EXPECT_EQ(trace.points().front().x, 0.0);
  EXPECT_NEAR(trace.points().back().x, 2000.0, 20.0);
}

TEST(LiveState, a_drive_begins_its_paths_anew_where_the_robot_rests) {
  LiveState state;
  state.connect(description(), true);
  state.take_status(status("idle"));
  for (const double x : {0.0, 0.5, 1.0}) state.take_message("ODOM", pose(x, 0.0, 0.0));
  state.take_status(status("moving: straight forward"));
  EXPECT_EQ(state.document()["pose"], ordered_json({0.0, 0.0, 0.0}));
  state.take_message("ODOM", pose(1.25, 0.0, 0.0));
  state.take_status(status("idle"));
  EXPECT_EQ(state.document()["pose"], ordered_json({0.25, 0.0, 0.0}));
}

TEST(LiveState, a_result_shows_three_paths_and_what_follows_goes_on_from_their_ends) {
  LiveState state;
  state.connect(description(), true);
  state.take_message("ODOM", pose(3.0, 0.0, 0.0));
  state.take_message("RESULT", result());
  state.take_message("ODOM", pose(3.5, 0.0, 0.0));
  const auto body = state.document();
  EXPECT_EQ(body["verdict"], "accepted");
  EXPECT_EQ(body["paths"]["reference"].back(), ordered_json({1.0, 0.0}));
  EXPECT_EQ(body["paths"]["odometry"].back(), ordered_json({1.5, 0.0}));
  EXPECT_EQ(body["paths"]["calibrated"].back(), ordered_json({1.0, 0.0}));
  for (const auto& row : body["parameters"])
    if (row["name"] == "track_width") {
      EXPECT_EQ(row["solved"], 0.41);
      EXPECT_EQ(row["std"], 0.0002);
    }
}

TEST(LiveState, beams_without_a_reading_are_left_out_and_the_others_stand_in_the_frame_of_the_base) {
  LiveState state;
  state.connect(description(), true);
  Scan scan;
  scan.range_min = 0.1;
  scan.range_max = 12.0;
  scan.angle_increment = std::acos(0.0);
  scan.ranges = {1.0F, 0.0F, 2.0F, 99.0F};
  state.take_message("SCAN", messages::encode(messages::Stamp{}, scan));
  EXPECT_EQ(state.document()["scan"], ordered_json({{1.1, 0.0}, {-1.9, 0.0}}));
  scan.ranges.assign(10'000, 1.0F);
  state.take_message("SCAN", messages::encode(messages::Stamp{}, scan));
  EXPECT_LE(state.document()["scan"].size(), LiveState::kMostBeams);
}

TEST(LiveState, without_lcm_it_says_so_and_follows_the_odometry_of_the_status) {
  LiveState state;
  state.connect(description(""), false);
  state.take_status(status("moving: straight forward", 1.0));
  state.take_status(status("moving: straight forward", 1.5));
  EXPECT_THAT(state.document()["telemetry"], HasSubstr("LCM is off"));
  EXPECT_EQ(state.document()["pose"][0], 0.5);
}

TEST(LiveState, without_lcm_scan_and_progress_are_those_that_were_asked_for) {
  LiveState state;
  state.connect(description(""), false);
  EXPECT_TRUE(state.needs_scan());
  auto moving = status("moving: straight forward");
  moving["progress"] = {{"phase", "straight"}, {"fraction", 0.25}, {"eta", 3.0}};
  state.take_status(moving);
  state.take_scan_answer({{"points", {{1.0, 2.0}, {"x", 1.0}, {3.0}, {-1.5, 0.25}}}});
  EXPECT_EQ(state.document()["scan"], ordered_json({{1.0, 2.0}, {-1.5, 0.25}})) << "frame of the base";
  EXPECT_EQ(state.document()["progress"]["fraction"], 0.25);
  state.take_status(status("idle"));
  EXPECT_TRUE(state.document()["progress"].is_null());
  for (const auto& wrong : {ordered_json(), ordered_json("x"), ordered_json({{"points", 1}})}) {
    state.take_scan_answer(wrong);
    EXPECT_TRUE(state.document()["scan"].empty());
  }
}

TEST(LiveState, with_lcm_nothing_is_asked_for) {
  LiveState state;
  state.connect(description(), true);
  state.take_message("ODOM", pose(0.0, 0.0, 0.0));
  EXPECT_FALSE(state.needs_scan());
}

ordered_json row_named(const ordered_json& body, const char* name) {
  for (const auto& row : body["parameters"])
    if (row["name"] == name) return row;
  return nullptr;
}

TEST(LiveState, what_is_known_of_a_parameter_shrinks_while_the_robot_drives) {
  LiveState state;
  state.connect(description(), true);
  state.take_parameters({{{"name", "left_wheel_diameter"}, {"unit", "m"}, {"value", 0.15}},
                         {{"name", "track_width"}, {"unit", "m"}, {"value", 0.4}}});
  const auto known_after = [&state](double stretches, double turns) {
    auto moving = status("moving");
    moving["recorded_motion"] = {{"straight", {{"stretches", stretches}, {"m", 0.15 * stretches}}},
                                 {"left", {{"stretches", turns}, {"rad", 0.3 * turns}}},
                                 {"right", {{"stretches", 0}, {"rad", 0.0}}}};
    state.take_status(moving);
    const auto body = state.document();
    return std::pair{row_named(body, "left_wheel_diameter")["known_to"],
                     row_named(body, "track_width")["known_to"]};
  };
  EXPECT_TRUE(known_after(0, 0).first.is_null());
  const auto few = known_after(4, 0), more = known_after(16, 8);
  EXPECT_NEAR(few.first.get<double>(), 0.15 * 2.0 * 1e-3 * 2.0 / 0.6, 1e-9);
  EXPECT_NEAR(more.first.get<double>(), 0.5 * few.first.get<double>(), 1e-9);
  EXPECT_TRUE(few.second.is_null()) << "nothing has turned";
  EXPECT_GT(more.second.get<double>(), 0.0);
  state.take_message("RESULT", result());
  EXPECT_EQ(row_named(state.document(), "track_width")["known_to"], 0.0004) << "two deviations of the solve";
}

TEST(LiveState, names_the_robot_and_what_stands_in_its_way) {
  LiveState state;
  state.connect(description(), true);
  auto stopped = status("idle");
  stopped["robot"] = {{"robot_id", "carrier-17"}};
  stopped["obstacle"] = "3 readings 0.4 m ahead";
  EXPECT_TRUE(state.document()["supply_voltage"].is_null());
  stopped["controller"] = {{"state", "enabled"}, {"supply_voltage", 25.9}};
  state.take_status(stopped);
  EXPECT_EQ(state.document()["robot"], "carrier-17");
  EXPECT_EQ(state.document()["obstacle"], "3 readings 0.4 m ahead");
  EXPECT_EQ(state.document()["supply_voltage"], 25.9);
}

TEST(LiveState, messages_that_never_come_are_named_and_those_that_do_are_not) {
  LiveState state;
  state.connect(description(), true);
  for (int k = 0; k < settings::kPatience; ++k) state.take_status(status("idle"));
  EXPECT_THAT(state.document()["telemetry"], HasSubstr("no LCM message arrives"));
  state.take_message("ODOM", pose(0.0, 0.0, 0.0));
  EXPECT_EQ(state.document()["telemetry"], "");
}

TEST(LiveState, bytes_that_are_no_message_change_nothing) {
  LiveState state;
  state.connect(description(), true);
  const auto before = state.document();
  for (const char* channel : {"ODOM", "ODOM_CALIBRATED", "SCAN", "PROGRESS", "RESULT", "OTHER"})
    for (const std::string& bytes :
         {std::string(), std::string("x"), result().substr(0, 40), messages::encode_json(0, "f", "{"),
          messages::encode_json(0, "f", "[1]"), messages::encode_json(0, "f", R"({"fraction":"1"})")})
      state.take_message(channel, bytes);
  EXPECT_EQ(state.document(), before);
}

TEST(PageServer, knows_its_own_names_only) {
  for (const char* own : {"127.0.0.1", "127.0.0.1:8038", "localhost", "localhost:1"})
    EXPECT_TRUE(is_own_host(own));
  for (const char* other :
       {"", "robots.example", "127.0.0.1.robots.example", "localhost:", "localhost:1@x", ":80"})
    EXPECT_FALSE(is_own_host(other)) << other;
}

TEST(PageServer, a_port_that_is_taken_is_an_error_that_names_it) {
  const auto state = [] { return std::string("{}"); };
  const auto first = value_of(PageServer::open(0, live_page(), state));
  const auto second = PageServer::open(first->port(), live_page(), state);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().text(), HasSubstr(std::to_string(first->port())));
}

}  // namespace
}  // namespace odomcalib::cli::live_state_test
