// Motions, stops and write-back of the service, in virtual time.
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <map>
#include <numbers>
#include <set>
#include <thread>

#include <odomcalib/path_t.hpp>

#include "drivers/can/candump.hpp"
#include "proto/calibration/report_data.hpp"
#include "proto/file_bytes.hpp"
#include "proto/wire/event_log.hpp"
#include "tests/integration/service_loop.hpp"

namespace odomcalib::service_test {
namespace {

TEST_F(ServiceLoop, straight_goes_out_and_back_and_leaves_a_recording) {
  acquire();
  TestClient mover(folder_ / "control");
  mover.call("Straight", {{"lease", lease_}, {"distance", 0.8}}, true);
  double farthest = 0.0;
  control::Reply reply;
  ASSERT_TRUE(run_until(
      [&] {
        farthest = std::max(farthest, robot_->pose().x);
        if (auto got = mover.reply()) reply = *got;
        return reply.parameters != "{}" || !reply.error.empty();
      },
      40.0));
  ASSERT_EQ(reply.error, "") << reply.parameters;
  EXPECT_NEAR(farthest, 0.8, 0.05);
  EXPECT_NEAR(robot_->pose().x, 0.0, 0.05);
  const json result = json::parse(reply.parameters)["result"];
  EXPECT_EQ(result["moves"].size(), 2U);
  EXPECT_GT(std::filesystem::file_size(result["recording"].get<std::string>()), 100000U);
  const auto frames =
      std::filesystem::path(result["recording"].get<std::string>()).replace_extension(".candump");
  std::ifstream log(frames, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(log)), {});
  drivers::CandumpReader reader(text);
  std::size_t positions = 0;
  while (const auto frame = reader.next()) positions += frame->id == 0x181 ? 1 : 0;
  EXPECT_GT(positions, 200U);
  EXPECT_EQ(reader.counters()["skipped"], 0U);
  run(0.5);
  EXPECT_EQ(status()["controller"]["state"], "disabled");
}

// Headings are those of the preview, from which the way was found to be free.
TEST_F(ServiceLoop, headings_count_from_the_start_of_the_motion_wherever_the_odometry_points) {
  acquire();
  TestClient mover(folder_ / "control");
  mover.call("Spin", {{"lease", lease_}, {"turns", 0.125}, {"direction", "ccw"}});
  ASSERT_EQ(wait_reply(mover, 20.0).error, "");
  const sim::Pose start = robot_->pose();
  ASSERT_GT(start.yaw, 0.6);
  mover.call("Calibrate", {{"lease", lease_}, {"options", {{"manoeuvre", "headings"}}}}, true);
  const auto way = [&] { return std::hypot(robot_->pose().x - start.x, robot_->pose().y - start.y); };
  ASSERT_TRUE(run_until([&] { return way() > 0.4; }, 20.0)) << service_->status_json();
  const double direction = std::atan2(robot_->pose().y - start.y, robot_->pose().x - start.x);
  EXPECT_NEAR(std::remainder(direction - start.yaw, 2.0 * std::numbers::pi), 0.5 * std::numbers::pi, 0.1);
}

TEST_F(ServiceLoop, nobody_moves_without_a_lease) {
  EXPECT_EQ(ask("Straight", {{"lease", "guess"}, {"distance", 0.8}}, 1.0).error,
            "org.odomcalib.Calibration.NotPermitted");
  EXPECT_LT(robot_->fastest_rim(), 1e-6);
}

TEST_F(ServiceLoop, a_lease_that_is_not_renewed_stops_within_250_ms) {
  acquire();
  Mover mover(*this);
  renewing_ = false;
  run(0.250);
  EXPECT_LT(robot_->fastest_rim(), 0.01);
  EXPECT_EQ(wait_reply(mover, 1.0).error, "org.odomcalib.Calibration.Cancelled");
}

// Held up for longer than a lease lasts: by what the daemon does itself, or with the whole machine.
class HeldUp : public ServiceLoop {
 protected:
  // The robot goes on, the service does not turn.
  void hold_up(double seconds, bool client_too) {
    for (double left = seconds; left > 0.0; left -= 0.03) {
      robot_->step(std::min(left, 0.03));
      clock_.time += std::min(left, 0.03);
      if (!client_too) renew();
    }
    // A kernel thread carries bytes through a pseudo-terminal; they would have arrived during the pause.
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  void renew() { client_->call("Renew", {{"lease", lease_}, {"sent", clock_.time}}); }
  void expect_end(TestClient& mover) {
    const auto end = wait_reply(mover, 40.0);
    EXPECT_EQ(end.error, "") << end.parameters;
  }
};

TEST_F(HeldUp, a_renewal_that_the_daemon_reads_late_counts_and_the_delay_is_told) {
  acquire();
  Mover mover(*this);
  hold_up(0.15, false);
  expect_end(mover);
  const json loop = status()["loop"];
  EXPECT_EQ(loop["late_steps"], 1) << loop;
  EXPECT_NEAR(loop["longest_turn"]["seconds"].get<double>(), 0.15, 0.02) << loop;
  EXPECT_EQ(loop["longest_turn"]["part"], "outside") << loop;
}

TEST_F(HeldUp, a_pause_of_the_whole_machine_does_not_end_a_motion) {
  acquire();
  Mover mover(*this);
  hold_up(0.15, true);
  expect_end(mover);
}

TEST_F(HeldUp, a_client_that_is_gone_after_the_pause_still_ends_it_and_the_reason_names_both_sides) {
  acquire();
  Mover mover(*this);
  renewing_ = false;
  hold_up(0.10, true);
  EXPECT_LT(time_to_rest(), 0.250);
  EXPECT_EQ(wait_reply(mover, 1.0).error, "org.odomcalib.Calibration.Cancelled");
  const std::string said = status()["last_stop"];
  EXPECT_NE(said.find("last renewal 1"), std::string::npos) << said;
  EXPECT_NE(said.find("loop in this motion was 10"), std::string::npos) << said;
}

TEST_F(HeldUp, a_daemon_that_was_away_for_longer_than_the_drives_watchdog_stops) {
  acquire();
  Mover mover(*this);
  hold_up(0.3, false);
  EXPECT_EQ(wait_reply(mover, 1.0).error, "org.odomcalib.Calibration.ProtectiveStop");
  EXPECT_LT(time_to_rest(), 0.5);
}

TEST_F(HeldUp, a_daemon_that_was_away_for_200_ms_stops_by_itself_too) {
  acquire();
  Mover mover(*this);
  robot_->node().dictionary().set({0x1016, 1}, 0);  // the drive no longer watches us
  hold_up(0.22, false);
  const auto reply = wait_reply(mover, 1.0);
  EXPECT_EQ(reply.error, "org.odomcalib.Calibration.ProtectiveStop");
  EXPECT_NE(reply.parameters.find("held up for"), std::string::npos) << reply.parameters;
}

TEST_F(ServiceLoop, a_machine_that_was_suspended_does_not_drive_on) {
  acquire();
  Mover mover(*this);
  clock_.slept += 60.0;  // the clock of all intervals stood still meanwhile
  const auto end = wait_reply(mover, 1.0);
  EXPECT_EQ(end.error, "org.odomcalib.Calibration.ProtectiveStop");
  EXPECT_NE(end.parameters.find("suspended for 60.0 s"), std::string::npos) << end.parameters;
  EXPECT_LT(time_to_rest(), 0.5);
}

TEST_F(ServiceLoop, a_closed_connection_stops_at_once) {
  acquire();
  Mover mover(*this);
  mover.hang_up();
  EXPECT_LT(time_to_rest(), 0.5);
}

TEST_F(ServiceLoop, a_lost_lidar_stops_and_nothing_restarts_when_it_is_back) {
  acquire();
  Mover mover(*this);
  robot_->unplug_lidar();
  EXPECT_LT(time_to_rest(), 0.8);
  EXPECT_EQ(wait_reply(mover, 1.0).error, "org.odomcalib.Calibration.ProtectiveStop");
  ASSERT_TRUE(robot_->plug_lidar().ok());
  run(3.0);
  EXPECT_LT(robot_->fastest_rim(), 1e-3);
}

TEST_F(ServiceLoop, stop_needs_no_lease) {
  acquire();
  Mover mover(*this);
  TestClient other(folder_ / "control");
  other.call("Stop", json::object());
  EXPECT_LT(time_to_rest(), 0.5);
  EXPECT_EQ(wait_reply(mover, 1.0).error, "org.odomcalib.Calibration.Cancelled");
}

// org.varlink.service: a call that wants no reply gets none, from a task neither.
TEST_F(ServiceLoop, a_call_that_wants_no_reply_gets_none) {
  acquire();
  TestClient quiet(folder_ / "control");
  for (const char* method : {"GetStatus", "Straight", "Nope"})
    quiet.call(method, {{"lease", lease_}, {"distance", 0.1}, {"one_way", true}}, false, true);
  EXPECT_TRUE(run_until([this] { return robot_->fastest_rim() > 0.05; }, 8.0));
  EXPECT_TRUE(run_until([this] { return ready(); }, 20.0));
  EXPECT_FALSE(quiet.reply());
  quiet.call("GetStatus", json::object());
  EXPECT_EQ(wait_reply(quiet, 1.0).error, "");
}

TEST_F(ServiceLoop, a_motion_that_was_asked_for_before_a_stop_does_not_begin_after_it) {
  acquire();
  TestClient mover(folder_ / "control"), other(folder_ / "control");
  mover.call("Straight", {{"lease", lease_}, {"distance", 1.0}});
  mover.call("Stop", json::object());
  EXPECT_EQ(wait_reply(mover, 1.0).error, "org.odomcalib.Calibration.Cancelled");
  EXPECT_EQ(wait_reply(mover, 1.0).error, "");
  run(1.0);
  EXPECT_LT(robot_->fastest_rim(), 1e-6);
  mover.call("Stop", json::object());
  start_straight(mover);
}

TEST_F(ServiceLoop, calls_get_a_few_milliseconds_of_a_turn_and_the_rest_later) {
  TestClient client(folder_ / "control");
  for (int i = 0; i < 10; ++i) client.call("GetStatus", json::object());
  clock_.each_look = 0.001;
  service_->poll_once(0);
  clock_.each_look = 0.0;
  int answered = 0;
  while (client.reply()) ++answered;
  EXPECT_GE(answered, 1);
  EXPECT_LE(answered, 4);
  EXPECT_TRUE(run_until([&] { return (answered += client.reply() ? 1 : 0) == 10; }, 0.1)) << answered;
}

TEST_F(ServiceLoop, stop_is_heard_however_many_clients_are_connected) {
  acquire();
  Mover mover(*this);
  std::vector<std::unique_ptr<TestClient>> crowd;
  for (int i = 0; i < 12; ++i) {
    crowd.push_back(std::make_unique<TestClient>(folder_ / "control"));
    run(0.03);
  }
  EXPECT_EQ(status()["clients"]["connected"], 10);
  EXPECT_EQ(status()["clients"]["too_many"], 6);
  crowd.push_back(std::make_unique<TestClient>(folder_ / "control"));
  crowd.back()->call("GetStatus", json::object());
  EXPECT_EQ(wait_reply(*crowd.back(), 0.5).error, "org.odomcalib.Calibration.Refused");
  EXPECT_GT(robot_->fastest_rim(), 0.15);
  TestClient last(folder_ / "control");
  last.call("Stop", json::object());
  EXPECT_LT(time_to_rest(), 0.5);
  EXPECT_EQ(wait_reply(mover, 1.0).error, "org.odomcalib.Calibration.Cancelled");
  EXPECT_EQ(wait_reply(last, 0.5).error, "");
}

TEST_F(ServiceLoop, an_ended_daemon_leaves_the_wheels_at_rest) {
  acquire();
  Mover mover(*this);
  service_.reset();
  for (int i = 0; i < 400; ++i) robot_->step(0.002);
  EXPECT_LT(robot_->fastest_rim(), 0.01);
}

TEST_F(ServiceLoop, a_lease_is_released_by_whoever_has_it_and_others_are_told_that_theirs_is_none) {
  acquire();
  EXPECT_EQ(ask("Release", {{"lease", "0123456789abcdef"}}, 0.1).error,
            "org.odomcalib.Calibration.NotPermitted");
  EXPECT_EQ(ask("Release", {{"lease", 7}}, 0.1).error, "org.varlink.service.InvalidParameter");
  EXPECT_EQ(ask("Renew", {{"lease", lease_}}, 0.1).error, "") << "it is in force as before";
  EXPECT_EQ(ask("Release", {{"lease", lease_}}, 0.1).error, "");
  EXPECT_EQ(ask("Release", {{"lease", lease_}}, 0.1).error, "org.odomcalib.Calibration.NotPermitted");
}

TEST_F(ServiceLoop, a_daemon_that_is_told_to_end_stops_a_motion_at_once_and_says_why) {
  acquire();
  Mover mover(*this);
  service_->stop_all("told to end");
  EXPECT_LT(time_to_rest(), 0.25);
  const auto reply = wait_reply(mover, 0.1);
  EXPECT_EQ(reply.error, "org.odomcalib.Calibration.Cancelled");
  EXPECT_NE(reply.parameters.find("told to end"), std::string::npos) << reply.parameters;
}

TEST_F(ServiceLoop, a_daemon_that_is_told_to_end_begins_nothing_and_still_tells_its_status) {
  acquire();
  service_->stop_all("told to end");
  const json wanted = {{"lease", lease_}, {"distance", 1.0}, {"values", {{"track_width", 0.4033}}}};
  for (const char* method : {"Straight", "Spin", "Calibrate", "SetParameters", "Record", "Acquire"}) {
    const auto reply = ask(method, wanted, 0.1);
    EXPECT_EQ(reply.error, "org.odomcalib.Calibration.Refused") << method;
    EXPECT_NE(reply.parameters.find("ending"), std::string::npos) << reply.parameters;
  }
  run(2.0);
  EXPECT_LT(robot_->fastest_rim(), 1e-6);
  EXPECT_EQ(robot_->node().geometry_in_ram()[2], 400000U);
  TestClient observer(folder_ / "control");
  observer.call("GetStatus", json::object());
  EXPECT_EQ(json::parse(wait_reply(observer, 0.1).parameters)["status"]["state"], "ending");
  observer.call("Stop", json::object());
  EXPECT_EQ(wait_reply(observer, 0.1).error, "");
}

TEST_F(ServiceLoop, a_write_back_that_is_under_way_is_waited_for) {
  acquire();
  TestClient writer(folder_ / "control");
  writer.call("SetParameters", {{"lease", lease_}, {"values", {{"track_width", 0.4033}}}});
  ASSERT_TRUE(run_until([this] { return service_->writing(); }, 1.0));
  service_->stop_all("told to end");
  ASSERT_TRUE(service_->writing());
  ASSERT_TRUE(run_until([this] { return !service_->writing(); }, 5.0));
  EXPECT_EQ(wait_reply(writer, 0.1).error, "");
  EXPECT_EQ(robot_->node().geometry_stored()[2], 403300U);
  run(3.0);
  EXPECT_FALSE(service_->writing()) << "nothing new begins";
}

TEST_F(ServiceLoop, a_stop_does_not_spoil_a_write_back) {
  acquire();
  TestClient writer(folder_ / "control"), other(folder_ / "control");
  writer.call("SetParameters", {{"lease", lease_}, {"values", {{"track_width", 0.4033}}}});
  ASSERT_TRUE(run_until([this] { return service_->writing(); }, 1.0));
  other.call("Stop", json::object());
  EXPECT_EQ(wait_reply(writer, 5.0).error, "");
  EXPECT_EQ(wait_reply(other, 0.1).error, "");
  EXPECT_EQ(robot_->node().geometry_stored()[2], 403300U);
}

// Rule M15: everyone may stop what turns, also where this daemon does not drive it.
TEST_F(ServiceLoop, a_stop_reaches_the_drive_though_nothing_runs_here) {
  for (const int word : {0x06, 0x07, 0x0F}) {
    robot_->inject(sim::make_frame(0x201, {word, 0}));
    run(0.05);
  }
  robot_->inject(sim::make_frame(0x301, {0xE8, 3, 0, 0, 0xE8, 3, 0, 0}));  // 10 rpm
  ASSERT_TRUE(run_until([this] { return robot_->fastest_rim() > 0.05; }, 3.0));
  EXPECT_EQ(ask("Stop", json::object(), 1.0).error, "");
  EXPECT_LT(time_to_rest(), 0.5);
}

// Fault F34: a motion of which nothing is kept is for nothing.
TEST_F(ServiceLoop, a_recording_that_fails_ends_the_motion) {
  acquire();
  Mover mover(*this);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit full = before;
  full.rlim_cur = 1;
  const auto ignored = signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &full);
  std::optional<control::Reply> got;
  for (int i = 0; i < 500 && !got; ++i) {  // the recording has a thread of its own, in real time
    run(0.01);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    got = mover.reply();
  }
  setrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, ignored);
  ASSERT_TRUE(got) << "it went on";
  EXPECT_EQ(got->error, "org.odomcalib.Calibration.Io") << got->parameters;
  EXPECT_LT(time_to_rest(), 0.5);
}

// The robot carries something that hides what is behind it: beams end on it.
class HalfBlind : public ServiceLoop {
 protected:
  void adjust(sim::SimRobotOptions& options) override { load(options.room); }
  static void load(sim::Room& room) { room.add_wall({-0.12, -0.15}, {-0.12, 0.15}); }
};

TEST_F(HalfBlind, what_the_lidar_does_not_see_is_told_before_anything_moves) {
  TestClient observer(folder_ / "control");
  observer.call("Straight", {{"distance", 0.3}, {"dry_run", true}});
  const json plan = json::parse(wait_reply(observer, 1.0).parameters)["result"];
  EXPECT_EQ(plan["unseen_moves"], json({"straight backward"})) << plan;
  ASSERT_EQ(plan["blind_sectors"].size(), 1U) << plan;
  EXPECT_NEAR(0.5 * (plan["blind_sectors"][0][0].get<double>() + plan["blind_sectors"][0][1].get<double>()),
              std::numbers::pi, 0.1);
  observer.call("Check", json::object());
  const json checks = json::parse(wait_reply(observer, 1.0).parameters)["checks"];
  for (const json& check : checks)
    if (check["name"] == "lidar view") {
      EXPECT_EQ(check["outcome"], "warn");
      EXPECT_NE(check["found"].get<std::string>().find("blind from 1"), std::string::npos) << check;
      return;
    }
  FAIL() << "no row about the view";
}

// Rule M10, whatever client it is: somebody stands for it, by name and for one motion.
TEST_F(HalfBlind, nothing_goes_where_the_lidar_sees_nothing_unless_somebody_vouches_for_it) {
  acquire();
  // Objects behind the robot do not move along, in this room.
  const auto drive = [this](const json& vouched_by) {
    TestClient mover(folder_ / "control");
    mover.call("Straight", {{"lease", lease_}, {"distance", 0.3}, {"vouched_by", vouched_by}});
    const bool begins =
        run_until([this] { return status()["state"].get<std::string>().starts_with("moving"); }, 0.5);
    if (begins) robot_->room() = sim::furnished_room();
    auto reply = wait_reply(mover, 20.0);
    EXPECT_EQ(begins, reply.error.empty()) << reply.parameters;
    return reply;
  };
  for (const json& nobody : {json(), json(""), json(" ")}) {
    const auto refused = drive(nobody);
    EXPECT_EQ(refused.error, "org.odomcalib.Calibration.Refused") << refused.parameters;
    EXPECT_NE(refused.parameters.find("straight backward"), std::string::npos) << refused.parameters;
  }
  EXPECT_EQ(drive(true).error, "org.varlink.service.InvalidParameter");
  const auto vouched = drive("Erika\nMustermann");
  ASSERT_EQ(vouched.error, "") << vouched.parameters;
  std::ifstream file(json::parse(vouched.parameters)["result"]["recording"].get<std::string>());
  const std::string recording((std::istreambuf_iterator<char>(file)), {});
  EXPECT_NE(recording.find("Erika?Mustermann vouches for this motion, asked for by "), std::string::npos);
  load(robot_->room());
  run(2.0);
  EXPECT_EQ(drive(json()).error, "org.odomcalib.Calibration.Refused") << "it was for that motion";
}

TEST_F(ServiceLoop, a_lidar_that_sees_all_around_has_nothing_to_ask) {
  const json plan = json::parse(ask("Spin", {{"turns", 1.0}, {"dry_run", true}}, 1.0).parameters)["result"];
  EXPECT_EQ(plan["unseen_moves"], json::array()) << plan;
  std::string view;
  const json checks = json::parse(ask("Check", json::object(), 1.0).parameters)["checks"];
  for (const json& check : checks)
    if (check["name"] == "lidar view") view = check["outcome"];
  EXPECT_EQ(view, "ok");
}

TEST_F(ServiceLoop, progress_is_told_five_times_a_second) {
  acquire();
  Mover mover(*this);
  (void)mover.reply();
  const int before = mover.continued();
  EXPECT_FALSE(run_until([&] { return mover.reply().has_value(); }, 2.0));
  EXPECT_GE(mover.continued() - before, 9);
  EXPECT_LE(mover.continued() - before, 11);
}

// Each wheel is held to its own value of the configuration.
TEST_F(ServiceLoop, a_right_wheel_of_another_size_is_named) {
  service_.reset();
  robot_->node().dictionary().set({0x2100, 2}, 125000);
  start_service();
  ASSERT_TRUE(run_until([this] { return ready(); }, 15.0)) << service_->status_json();
  EXPECT_NEAR(status()["robot"]["left_wheel_diameter"], 0.150, 1e-9);
  EXPECT_NEAR(status()["robot"]["right_wheel_diameter"], 0.125, 1e-9);
  const auto reply = ask("Straight", {{"distance", 0.5}, {"dry_run", true}}, 2.0);
  EXPECT_NE(reply.parameters.find("right_wheel_diameter = 0.1250 m"), std::string::npos) << reply.parameters;
}

// 0.05 m in the controller of wheels of 0.15 m: what is called 0.3 m/s would be 0.9.
class OtherWheels : public ServiceLoop {
 protected:
  void adjust(Config& config) override { config.robot.left_wheel_diameter = 0.450; }
};

TEST_F(OtherWheels, than_those_of_the_configuration_do_not_turn) {
  acquire();
  const auto reply = ask("Straight", {{"lease", lease_}, {"distance", 0.5}}, 1.0);
  EXPECT_EQ(reply.error, "org.odomcalib.Calibration.Refused");
  EXPECT_NE(reply.parameters.find("left_wheel_diameter = 0.1500 m"), std::string::npos) << reply.parameters;
  EXPECT_LT(robot_->fastest_rim(), 1e-6);
}

TEST_F(ServiceLoop, nothing_moves_before_the_values_of_the_controller_were_read) {
  service_.reset();
  robot_->reset_drive();
  start_service();
  acquire();
  std::set<std::string> said;
  for (int i = 0; i < 400 && status()["robot"]["in_controller"] == false; ++i) {
    const auto reply = ask("Straight", {{"lease", lease_}, {"distance", 0.5}}, 0.2);
    ASSERT_EQ(reply.error.substr(0, 27), "org.odomcalib.Calibration.D") << reply.parameters;
    said.insert(json::parse(reply.parameters)["what"]);
  }
  EXPECT_TRUE(said.contains("the controller's values were not read yet")) << json(said);
  EXPECT_LT(robot_->fastest_rim(), 1e-6);
}

TEST_F(ServiceLoop, a_motion_of_many_hours_is_refused_at_once) {
  acquire();
  const auto reply = ask("Spin", {{"lease", lease_}, {"turns", 10.0}, {"rate", 0.05}, {"repeat", 20}}, 1.0);
  EXPECT_EQ(reply.error, "org.odomcalib.Calibration.Usage");
  EXPECT_NE(reply.parameters.find("minutes"), std::string::npos) << reply.parameters;
}

// File names are bytes; so is what a device says of itself.
class ForeignText : public ServiceLoop {
 protected:
  void adjust(Config& config) override {
    const auto link = folder_ / "lidar\xFF";
    std::filesystem::create_symlink(robot_->lidar_path(), link);
    config.lidar_device = "serial:" + link.string() + "?baud=230400";
  }
};

TEST_F(ForeignText, that_is_no_utf8_does_not_end_the_daemon) {
  EXPECT_NE(status()["lidar"]["device"].get<std::string>().find("\uFFFD"), std::string::npos);
  run(2.0);
  EXPECT_EQ(status()["lidar"]["connected"], true);
}

// Rule M19: the robot is named who else drives it, and stands.
TEST_F(ServiceLoop, another_program_that_commands_the_drive_stops_the_motion) {
  acquire();
  Mover mover(*this);
  robot_->inject(sim::make_frame(0x301, {0x10, 0, 0, 0, 0x10, 0, 0, 0}));
  const double begin = clock_.time;
  const auto reply = wait_reply(mover, 1.0);
  EXPECT_LT(clock_.time - begin, 0.1);
  EXPECT_EQ(reply.error, "org.odomcalib.Calibration.ProtectiveStop");
  EXPECT_NE(reply.parameters.find("another program sends speeds or control words"), std::string::npos)
      << reply.parameters;
  EXPECT_LT(time_to_rest(), 1.0);
}

TEST_F(ServiceLoop, values_written_are_stored_and_survive_a_reset_of_the_node) {
  acquire();
  TestClient writer(folder_ / "control");
  writer.call(
      "SetParameters",
      {{"lease", lease_},
       {"values",
        {{"left_wheel_diameter", 0.1512}, {"right_wheel_diameter", 0.1498}, {"track_width", 0.4033}}}});
  const auto reply = wait_reply(writer, 10.0);
  ASSERT_EQ(reply.error, "") << reply.parameters;
  const std::array<std::uint32_t, 3> expected{151200, 149800, 403300};
  EXPECT_EQ(robot_->node().geometry_in_ram(), expected);
  EXPECT_EQ(robot_->node().geometry_stored(), expected);
  EXPECT_EQ(robot_->node().store_count(), 1U);
  robot_->reset_drive();
  run(3.0);
  EXPECT_EQ(robot_->node().geometry_in_ram(), expected);
  writer.call("Rollback", {{"lease", lease_}});
  ASSERT_EQ(wait_reply(writer, 10.0).error, "");
  EXPECT_EQ(robot_->node().geometry_stored(), (std::array<std::uint32_t, 3>{150000, 150000, 400000}));
}

TEST_F(ServiceLoop, a_store_that_fails_leaves_the_old_values_or_asks_for_an_operator) {
  acquire();
  robot_->node().faults.store_fails = true;
  const auto reply = ask("SetParameters", {{"lease", lease_}, {"values", {{"track_width", 0.4033}}}}, 30.0);
  EXPECT_EQ(reply.error, "org.odomcalib.Calibration.WriteUnknown");
  EXPECT_EQ(robot_->node().geometry_in_ram()[2], 400000U);
  EXPECT_EQ(status()["operator_needed"], true);
}

// Calls whose parameters are of a wrong type: what they would do, and which parameter the answer must name.
struct WrongCall {
  const char* name;
  const char* method;
  json parameters;
  const char* parameter;
};

class WrongParameter : public ServiceLoop, public testing::WithParamInterface<WrongCall> {};

TEST_P(WrongParameter, is_refused_by_name_and_nothing_moves_or_is_written) {
  acquire();
  TestClient caller(folder_ / "control");
  json parameters = GetParam().parameters;
  parameters["lease"] = lease_;
  caller.call(GetParam().method, parameters);
  const auto reply = wait_reply(caller, 1.0);
  EXPECT_EQ(reply.error, "org.varlink.service.InvalidParameter") << reply.parameters;
  EXPECT_EQ(json::parse(reply.parameters).value("parameter", ""), GetParam().parameter);
  run(1.0);
  EXPECT_LT(robot_->fastest_rim(), 1e-6);
  EXPECT_EQ(status()["state"], "idle");
  EXPECT_EQ(robot_->node().store_count(), 0U);
}

// NaN and infinity arrive as null (rule M17).
INSTANTIATE_TEST_SUITE_P(
    Service, WrongParameter,
    testing::Values(
        WrongCall{"null_distance", "Straight", {{"distance", nullptr}}, "distance"},
        WrongCall{"no_distance", "Straight", json::object(), "distance"},
        WrongCall{"distance_in_quotes", "Straight", {{"distance", "1"}}, "distance"},
        WrongCall{"null_speed", "Straight", {{"distance", 1.0}, {"speed", nullptr}}, "speed"},
        WrongCall{"half_repeat", "Straight", {{"distance", 1.0}, {"repeat", 1.5}}, "repeat"},
        WrongCall{"numeric_dry_run", "Straight", {{"distance", 1.0}, {"dry_run", 1}}, "dry_run"},
        WrongCall{"null_turns", "Spin", {{"turns", nullptr}}, "turns"},
        WrongCall{"null_rate", "Spin", {{"turns", 1.0}, {"rate", nullptr}}, "rate"},
        WrongCall{"direction_up", "Spin", {{"turns", 1.0}, {"direction", "up"}}, "direction"},
        WrongCall{"misspelt_dry_run", "Straight", {{"distance", 1.0}, {"dryrun", true}}, "dryrun"},
        WrongCall{"square_in_quotes", "Straight", {{"distance", 1.0}, {"square", "yes"}}, "square"},
        WrongCall{"numeric_nudge", "Check", {{"nudge", 1}}, "nudge"},
        WrongCall{"calibrate_null_speed", "Calibrate", {{"options", {{"speed", nullptr}}}}, "options.speed"},
        WrongCall{"calibrate_effects", "Calibrate", {{"options", {{"effects", "none"}}}}, "options.effects"},
        WrongCall{
            "misspelt_manoeuvre", "Calibrate", {{"options", {{"manouvre", "arcs"}}}}, "options.manouvre"},
        WrongCall{"speed_of_a_manoeuvre",
                  "Calibrate",
                  {{"options", {{"manoeuvre", "arcs"}, {"speed", 0.1}}}},
                  "options.speed"},
        WrongCall{"record_null_duration", "Record", {{"duration", nullptr}}, "duration"},
        WrongCall{"set_null", "SetParameters", {{"values", nullptr}}, "values"},
        WrongCall{"set_nothing", "SetParameters", {{"values", json::object()}}, "values"},
        WrongCall{"set_null_value",
                  "SetParameters",
                  {{"values", {{"track_width", nullptr}}}},
                  "values.track_width"},
        WrongCall{"set_misspelt_dry_run",
                  "SetParameters",
                  {{"values", {{"track_width", 0.4033}}}, {"dry-run", true}},
                  "dry-run"},
        WrongCall{"rollback_numeric_id", "Rollback", {{"id", 5}}, "id"},
        WrongCall{"apply_nothing", "Apply", {{"calibration", nullptr}}, "calibration"},
        WrongCall{"monitor_without_more", "Monitor", json::object(), "more"}),
    [](const auto& one) { return std::string(one.param.name); });

TEST_F(ServiceLoop, an_optional_text_that_is_null_is_an_absent_one) {
  acquire();
  const auto reply =
      ask("Spin", {{"lease", lease_}, {"turns", 1.0}, {"direction", nullptr}, {"dry_run", true}}, 1.0);
  ASSERT_EQ(reply.error, "") << reply.parameters;
  EXPECT_EQ(json::parse(reply.parameters)["result"]["moves"], 2);
}

TEST_F(ServiceLoop, what_a_check_found_follows_its_outcome) {
  const auto checks = [this] {
    TestClient asker(folder_ / "control");
    asker.call("Check", json::object());
    std::map<std::string, json> found;
    const json reply = json::parse(wait_reply(asker, 1.0).parameters);
    for (const auto& check : reply["checks"]) found[check["name"]] = check;
    return found;
  };
  const auto good = checks();
  acquire();
  robot_->node().faults.store_fails = true;
  (void)ask("SetParameters", {{"lease", lease_}, {"values", {{"track_width", 0.4033}}}}, 30.0);
  robot_->unplug_lidar();
  std::filesystem::remove_all(folder_ / "state");
  run(1.0);
  const auto bad = checks();
  for (const char* name : {"lidar port", "scans", "write-back", "disk"}) {
    EXPECT_EQ(good.at(name)["outcome"], "ok") << good.at(name);
    EXPECT_EQ(bad.at(name)["outcome"], "fail") << bad.at(name);
    EXPECT_NE(bad.at(name)["found"], good.at(name)["found"]);
    EXPECT_NE(bad.at(name)["found"], "") << name;
  }
}

TEST_F(ServiceLoop, S0_21_status_counts_the_motions_of_the_newest_recording) {
  EXPECT_EQ(status()["recorded_motion"]["missing"].size(), 2U);
  acquire();
  TestClient mover(folder_ / "control");
  mover.call("Straight", {{"lease", lease_}, {"distance", 1.0}}, true);
  ASSERT_EQ(wait_reply(mover, 60.0).error, "");
  json motion = status()["recorded_motion"];
  EXPECT_NEAR(motion["straight"]["m"].get<double>(), 2.0, 0.2) << motion;
  EXPECT_EQ(motion["missing"].size(), 1U) << motion;
  mover.call("Spin", {{"lease", lease_}, {"turns", 1}}, true);
  ASSERT_EQ(wait_reply(mover, 120.0).error, "");
  motion = status()["recorded_motion"];
  EXPECT_GT(motion["left"]["stretches"].get<int>() + motion["right"]["stretches"].get<int>(), 20) << motion;
  EXPECT_LT(motion["straight"]["m"].get<double>(), 0.2) << "that of the recording before";
}

TEST_F(ServiceLoop, a_recording_ends_with_the_client_that_asked_for_it) {
  TestClient recorder(folder_ / "control");
  recorder.call("Record", {{"name", "left_alone"}}, true);
  ASSERT_TRUE(run_until([this] { return status()["state"] == "recording"; }, 2.0));
  run(1.0);
  recorder.hang_up();
  EXPECT_TRUE(run_until([this] { return status()["state"] == "idle"; }, 5.0)) << status()["state"];
  std::uintmax_t bytes = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder_ / "state" / "recordings"))
    if (file.path().filename().string().starts_with("left_alone")) bytes += file.file_size();
  EXPECT_GT(bytes, 1000U) << "what was recorded is kept";
}

// A solver that goes on until it is told to end, or the test has lasted for too long.
class EndlessSolve : public ServiceLoop {
 protected:
  Calibrator calibrator() override {
    Calibrator functions;
    functions.solve = [this](const std::vector<std::filesystem::path>& /*recordings*/,
                             const std::vector<std::string>& /*effects*/,
                             const Calibrator::Progress& progress) {
      using Clock = std::chrono::steady_clock;
      solving_ = true;
      for (const auto end = Clock::now() + std::chrono::seconds(10); Clock::now() < end;) {
        progress("fitting", 0.5);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      Calibration nothing;
      return nothing;
    };
    return functions;
  }
  std::atomic<bool> solving_{false};
};

TEST_F(EndlessSolve, stop_ends_a_solve_at_its_next_progress_report) {
  acquire();
  TestClient caller(folder_ / "control");
  caller.call("Calibrate", {{"lease", lease_}, {"options", {{"manoeuvre", "headings"}}}}, true);
  ASSERT_TRUE(run_until([this] { return solving_.load(); }, 600.0)) << service_->status_json();
  TestClient other(folder_ / "control");
  other.call("Stop", json::object());
  std::optional<control::Reply> reply;
  for (int i = 0; i < 1000 && !reply; ++i) {
    step();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    reply = caller.reply();
  }
  ASSERT_TRUE(reply.has_value()) << "it goes on solving";
  EXPECT_EQ(reply->error, "org.odomcalib.Calibration.Cancelled") << reply->parameters;
  EXPECT_NE(reply->parameters.find("headings"), std::string::npos) << "where the recording is";
  EXPECT_EQ(status()["state"], "idle");
}

// LCM goes to a file in place of the network, as the library has it.
class PathsOnLcm : public ServiceLoop {
 protected:
  void adjust(Config& config) override {
    config.lcm_enabled = true;
    config.lcm_url = "file://" + (folder_ / "sent.lcmlog").string() + "?mode=w";
  }
  Calibrator calibrator() override {
    Calibrator functions;
    functions.solve = [](const auto&, const auto&, const auto&) -> Result<Calibration> {
      ReportData drive;
      drive.paths = {{"odometry", {{0.0, 0.0, 0.0}, {1.0, 0.5, 0.25}}},
                     {"calibrated", {{0.0, 0.0, 0.0}, {1.1, 0.4, 0.2}}},
                     {"reference", {{0.0, 0.0, 0.0}, {1.2, 0.3, 0.1}}}};
      Calibration calibration;
      store_report_data(drive, calibration);
      return calibration;
    };
    return functions;
  }
  std::vector<odomcalib::path_t> sent_paths() const {
    const auto bytes = read_file_bytes(folder_ / "sent.lcmlog");
    std::vector<odomcalib::path_t> paths;
    if (!bytes) return paths;
    EventLogReader log(bytes.value());
    while (const auto event = log.next()) {
      if (event->channel != "ODOMCALIB_PATH") continue;
      const auto size = static_cast<int>(event->data.size());
      if (path_t path{}; path.decode(event->data.data(), 0, size) == size) paths.push_back(path);
    }
    return paths;
  }
};

TEST_F(PathsOnLcm, S0_19_three_paths_in_one_frame_follow_a_solve) {
  acquire();
  TestClient caller(folder_ / "control");
  caller.call("Calibrate", {{"lease", lease_}, {"options", {{"manoeuvre", "headings"}}}}, true);
  std::optional<control::Reply> reply;
  ASSERT_TRUE(run_until([&] { return (reply = caller.reply()).has_value(); }, 600.0));
  ASSERT_EQ(reply->error, "") << reply->parameters;
  service_.reset();  // closes the file
  const auto paths = sent_paths();
  ASSERT_EQ(paths.size(), 3U);
  EXPECT_EQ(paths[0].name, "odometry");
  EXPECT_EQ(paths[1].name, "calibrated");
  EXPECT_EQ(paths[2].name, "scan");
  EXPECT_EQ(paths[2].x, (std::vector{0.0, 1.2}));
  EXPECT_EQ(paths[2].y, (std::vector{0.0, 0.3}));
  EXPECT_EQ(paths[2].yaw, (std::vector{0.0, 0.1}));
}

// The names are asked before anything moves.
class PickyCalibrator : public ServiceLoop {
 protected:
  Calibrator calibrator() override {
    Calibrator functions;
    functions.wrong_effects = [](const std::vector<std::string>& names) {
      const bool known = names == std::vector<std::string>{"none"};
      return known ? std::nullopt : std::optional(Error{ErrorCode::usage, "no such effect", "", ""});
    };
    return functions;
  }
};

TEST_F(PickyCalibrator, an_unknown_effect_is_refused_before_the_drive) {
  acquire();
  TestClient caller(folder_ / "control");
  const auto wanted = [&](const char* name) {
    return json{{"lease", lease_}, {"dry_run", true}, {"options", {{"effects", json::array({name})}}}};
  };
  caller.call("Calibrate", wanted("tme_offset"));
  EXPECT_EQ(wait_reply(caller, 1.0).error, "org.odomcalib.Calibration.Usage");
  caller.call("Calibrate", wanted("none"));
  EXPECT_EQ(wait_reply(caller, 1.0).error, "");
}

}  // namespace
}  // namespace odomcalib::service_test
