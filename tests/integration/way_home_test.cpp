// Values that may be written at all, the target of a rollback, and the knowledge afterwards of who wrote
// what: the real driver on the simulated drive, in virtual time.
#include <unistd.h>

#include <fstream>

#include "daemon/writeback/history.hpp"
#include "daemon/writeback/journal.hpp"
#include "tests/integration/service_loop.hpp"

namespace odomcalib::way_home_test {
namespace {

class WayHome : public ServiceLoop {
 protected:
  void adjust(Config& config) override {
    config.robot.robot_id = robot_id_;
    config.robot.track_width = nominal_track_;
  }
  /// The lidar sees what odometry tells, less this share of it.
  Calibrator calibrator() override {
    Calibrator functions;
    functions.match = [this](const Scan&, const Scan&, const routines::Pose& guess, const auto&) {
      const double share = 1.0 - off_;
      return std::optional(routines::Pose{share * guess.x, share * guess.y, share * guess.yaw});
    };
    functions.unit_of_effect = [](const std::string& effect, const std::string&) {
      return effect == "time_offset" ? std::optional<std::string>("s") : std::nullopt;
    };
    return functions;
  }
  EventLog log() override {
    return [this](messages::Severity, const std::string& code, const std::string& text) {
      events_ += code + ": " + text + "\n";
    };
  }
  control::Reply call(const std::string& method, json parameters = json::object()) {
    if (lease_.empty()) acquire();
    parameters["lease"] = lease_;
    return ask(method, parameters, 60.0);
  }
  control::Reply set_track(double metres) {
    return call("SetParameters", {{"values", {{"track_width", metres}}}});
  }
  [[nodiscard]] double track() { return 1e-6 * robot_->node().geometry_stored()[2]; }
  json history() { return json::parse(call("History").parameters)["entries"]; }
  void expect_refused(const control::Reply& reply, const std::vector<std::string>& said) {
    EXPECT_EQ(reply.error, "org.odomcalib.Calibration.Refused") << reply.parameters;
    for (const auto& text : said)
      EXPECT_NE(reply.parameters.find(text), std::string::npos) << text << " in " << reply.parameters;
  }
  /// The daemon begins again, with whatever has changed.
  void restart() {
    end_service();
    start_service();
    ASSERT_TRUE(run_until([this] { return ready(); }, 20.0)) << service_->status_json();
  }
  /// Another drive in the place of the one that was there: it holds what it came with.
  void replace_drive(std::uint32_t serial, std::uint32_t track_um) {
    sim::DriveNode& node = robot_->node();
    node.dictionary().set({0x1018, 4}, serial);
    node.dictionary().set({0x2100, 3}, track_um);
    restart();
  }
  static json calibration() {
    json body = {{"format", "odomcalib-calibration/1"}, {"verdict", "accepted"}};
    for (const auto& [name, value] :
         {std::pair("left_wheel_diameter", 0.1512), std::pair("track_width", 0.4033)})
      body["parameters"][name] = {{"value", value}, {"std", 1e-5}, {"unit", "m"}};
    body["effects"] = {{{"name", "time_offset"},
                        {"parameters", {{"offset", {{"value", 0.02}, {"std", 1e-3}, {"unit", "s"}}}}},
                        {"evidence", {{"p_value", 0.001}}},
                        {"stored_in", "host"}}};
    return body;
  }
  control::Reply apply(const json& body, json besides = {{"of_this_robot", true}}) {
    besides["calibration"] = body;
    return call("Apply", std::move(besides));
  }
  /// A straight and a turn, with a lidar that sees so much less.
  void drive(double off) {
    off_ = off;
    ASSERT_EQ(call("Straight", {{"distance", 0.5}}).error, "");
    ASSERT_EQ(call("Spin", {{"turns", 0.5}}).error, "");
  }

  std::string robot_id_;
  double nominal_track_ = 0.4, off_ = 0.0;
  std::string events_;
};

// --- One band around what is nominal ---------------------------------------------------------------------

// Six write-backs, each of them within 15 % of the one before, went from 0.400 to 0.878 m.
TEST_F(WayHome, six_write_backs_do_not_walk_away_from_what_is_nominal) {
  double wanted = 0.4;
  for (int i = 0; i < 6; ++i) {
    wanted *= 1.14;
    const auto reply = set_track(wanted);
    if (i > 0) expect_refused(reply, {"15 %", "nominal 0.4 m", "the configuration"});
    EXPECT_EQ(reply.error.empty(), i == 0) << reply.parameters;
  }
  EXPECT_NEAR(track(), 0.456, 1e-6);
  EXPECT_EQ(set_track(0.4).error, "") << "the way back is no dead end";
  EXPECT_NEAR(track(), 0.4, 1e-6);
}

TEST_F(WayHome, the_band_ends_15_percent_from_nominal_on_both_sides) {
  ASSERT_EQ(set_track(0.4 * 1.149).error, "");
  expect_refused(set_track(0.4 * 1.151), {"15 %"});
  ASSERT_EQ(set_track(0.4 * 0.851).error, "") << "however far that is from what is present";
  expect_refused(set_track(0.4 * 0.849), {"15 %"});
}

TEST_F(WayHome, names_what_it_passes_over_because_it_cannot_be_read) {
  ASSERT_EQ(set_track(0.41).error, "");
  std::ofstream(folder_ / "state" / "history" / "0000.json") << "{";
  restart();
  EXPECT_NE(events_.find("0000.json: holds no write-back that can be read"), std::string::npos) << events_;
  EXPECT_EQ(events_.find("0001.json"), std::string::npos) << events_;
}

TEST_F(WayHome, rollback_tells_an_entry_that_cannot_be_read_from_one_that_was_never_committed) {
  EXPECT_NE(call("Rollback").parameters.find("no write-back was committed\""), std::string::npos);
  std::filesystem::create_directories(folder_ / "state" / "history");
  std::ofstream(folder_ / "state" / "history" / "0007.json") << "{";
  restart();
  auto reply = call("Rollback").parameters;
  EXPECT_NE(reply.find("no write-back that can be read was committed, and 1 cannot"), std::string::npos)
      << reply;
  reply = call("Rollback", {{"id", "0007"}}).parameters;
  EXPECT_NE(reply.find("0007.json"), std::string::npos) << reply;
  reply = call("Rollback", {{"id", "0006"}}).parameters;
  EXPECT_NE(reply.find("that was committed"), std::string::npos) << reply;
}

TEST_F(WayHome, a_history_that_cannot_be_listed_is_told_and_not_taken_for_an_empty_one) {
  end_service();
  std::filesystem::remove_all(folder_ / "state" / "history");
  std::ofstream(folder_ / "state" / "history") << "no folder";
  start_service();
  ASSERT_TRUE(run_until([this] { return ready(); }, 20.0));
  EXPECT_NE(
      events_.find("history: " + (folder_ / "state" / "history").string() + ": cannot read the history: "),
      std::string::npos)
      << events_;
  for (const auto& reply : {call("History"), call("Rollback"), call("Rollback", {{"id", "0001"}})})
    EXPECT_NE(reply.parameters.find("cannot read the history: "), std::string::npos) << reply.parameters;
}

TEST_F(WayHome, a_history_that_can_be_listed_again_is_read_and_written_to_without_a_restart) {
  ASSERT_EQ(set_track(0.41).error, "");
  ASSERT_EQ(set_track(0.42).error, "");
  const auto history_folder = folder_ / "state" / "history", aside = folder_ / "aside";
  end_service();
  std::filesystem::rename(history_folder, aside);
  std::filesystem::remove(aside / "0002.json");  // the journal alone knows it
  std::ofstream(history_folder) << "no folder";
  start_service();
  ASSERT_TRUE(run_until([this] { return ready(); }, 20.0));
  for (const auto& reply : {set_track(0.43), call("History"), call("Rollback"), set_track(0.43)})
    EXPECT_NE(reply.parameters.find("cannot read the history: "), std::string::npos) << reply.parameters;
  EXPECT_NEAR(track(), 0.42, 1e-6) << "nothing is written whose entry would have the number of another one";

  std::filesystem::remove(history_folder);
  std::filesystem::rename(aside, history_folder);
  std::ofstream(history_folder / "0000.json") << "{";
  ASSERT_TRUE(run_until([this] { return events_.find("can be read again") != std::string::npos; }, 5.0));
  EXPECT_NE(events_.find("write-backs in it: 2"), std::string::npos) << events_;
  EXPECT_NE(events_.find("0000.json: holds no write-back"), std::string::npos) << events_;
  EXPECT_TRUE(std::filesystem::exists(history_folder / "0002.json"));
  EXPECT_EQ(set_track(0.43).error, "");
  ASSERT_EQ(history().size(), 3U);
  EXPECT_EQ(history()[0]["id"], "0003");
  ASSERT_EQ(call("Rollback").error, "");
  EXPECT_NEAR(track(), 0.42, 1e-6);
}

// Without a journal nothing waits to be written to the history, which would be refused in any case.
TEST_F(WayHome, nothing_is_written_while_nobody_knows_which_entries_there_are) {
  ASSERT_EQ(set_track(0.41).error, "");
  const auto history_folder = folder_ / "state" / "history", aside = folder_ / "aside";
  end_service();
  std::filesystem::rename(history_folder, aside);
  std::filesystem::remove(folder_ / "state" / "journal");
  std::ofstream(history_folder) << "no folder";
  start_service();
  ASSERT_TRUE(run_until([this] { return ready(); }, 20.0));
  const auto reply = set_track(0.42);
  EXPECT_NE(reply.parameters.find("cannot read the history: "), std::string::npos) << reply.parameters;
  EXPECT_NEAR(track(), 0.41, 1e-6);
  std::filesystem::remove(history_folder);
  std::filesystem::rename(aside, history_folder);
  ASSERT_TRUE(run_until([this] { return events_.find("can be read again") != std::string::npos; }, 5.0));
  ASSERT_EQ(set_track(0.42).error, "");
  EXPECT_EQ(history()[0]["id"], "0002");
}

TEST_F(WayHome, a_damaged_record_of_the_last_run_is_told) {
  end_service();
  std::ofstream(folder_ / "state" / "last_run.json") << "{";
  start_service();
  ASSERT_TRUE(run_until([this] { return ready(); }, 20.0));
  EXPECT_NE(events_.find("last_run: " + (folder_ / "state" / "last_run.json").string() + ": is damaged; "),
            std::string::npos)
      << events_;
  const json status = json::parse(service_->status_json());
  EXPECT_NE(status["last_stop"].get<std::string>().find("not known: "), std::string::npos) << status;
  events_.clear();
  restart();
  EXPECT_EQ(events_.find("last_run:"), std::string::npos) << events_;
}

TEST_F(WayHome, damage_of_the_journal_is_told_at_the_start) {
  ASSERT_EQ(set_track(0.41).error, "");
  end_service();
  std::ofstream(folder_ / "state" / "journal", std::ios::app) << "damaged\nabc";
  start_service();
  ASSERT_TRUE(run_until([this] { return ready(); }, 20.0));
  EXPECT_NE(events_.find("journal: " + (folder_ / "state" / "journal").string() + ": line "),
            std::string::npos)
      << events_;
  events_.clear();
  std::filesystem::remove(folder_ / "state" / "journal");
  restart();
  EXPECT_EQ(events_.find("journal:"), std::string::npos) << events_;
}

// 20 % off is what a drive of another robot may hold: it is put right in one step.
TEST_F(WayHome, a_replaced_drive_is_put_right_in_one_step) {
  robot_->node().dictionary().set({0x2100, 3}, 480000);
  restart();
  ASSERT_NEAR(status()["robot"]["track_width"].get<double>(), 0.48, 1e-9);
  EXPECT_EQ(set_track(0.4033).error, "");
  EXPECT_NEAR(track(), 0.4033, 1e-6);
}

TEST_F(WayHome, without_a_nominal_value_nothing_is_written) {
  nominal_track_ = 0.0;
  restart();
  expect_refused(set_track(0.4), {"track_width has no nominal value"});
}

TEST_F(WayHome, journal_and_history_keep_what_is_nominal_and_where_it_is_stated) {
  ASSERT_EQ(set_track(0.41).error, "");
  const JournalRecord record = Journal::open(folder_ / "state" / "journal").value().last().value();
  const json entry = history()[0];
  EXPECT_EQ(record.origin.nominal.at("track_width"), 0.4);
  EXPECT_EQ(entry["nominal"]["track_width"], 0.4);
  EXPECT_EQ(record.origin.nominal_from.at("track_width"), "robot.track_width of the configuration");
  EXPECT_EQ(entry["nominal_from"]["track_width"], "robot.track_width of the configuration");
  EXPECT_EQ(record.origin.entry, entry["id"]);
}

// --- Where a rollback goes -------------------------------------------------------------------------------

TEST_F(WayHome, rollback_goes_one_entry_further_back_each_time_and_names_it) {
  for (const double metres : {0.41, 0.42, 0.43}) ASSERT_EQ(set_track(metres).error, "");
  const auto goes_to = [](const control::Reply& reply) {
    EXPECT_EQ(reply.error, "") << reply.parameters;
    return json::parse(reply.parameters)["result"].value("goes_to", "");
  };
  EXPECT_EQ(goes_to(call("Rollback", {{"dry_run", true}})),
            "the values before entry 0003, verified as entry 0002");
  EXPECT_NEAR(track(), 0.43, 1e-6);
  EXPECT_EQ(goes_to(call("Rollback")), "the values before entry 0003, verified as entry 0002");
  EXPECT_NEAR(track(), 0.42, 1e-6);
  EXPECT_EQ(goes_to(call("Rollback")), "the values before entry 0002, verified as entry 0001");
  EXPECT_NEAR(track(), 0.41, 1e-6);
  EXPECT_EQ(goes_to(call("Rollback")), "the values before entry 0001");
  EXPECT_NEAR(track(), 0.40, 1e-6);
  const auto end = call("Rollback");
  EXPECT_EQ(end.error, "org.odomcalib.Calibration.Usage");
  EXPECT_NE(end.parameters.find("nothing is further back"), std::string::npos) << end.parameters;
  EXPECT_EQ(goes_to(call("Rollback", {{"to", "0003"}})), "the values of entry 0003");
  EXPECT_NEAR(track(), 0.43, 1e-6);
  EXPECT_EQ(goes_to(call("Rollback")), "the values before entry 0003, verified as entry 0004")
      << "from there it goes on";
  EXPECT_NE(events_.find("rollback to the values before entry 0002"), std::string::npos) << events_;
  EXPECT_EQ(history()[1]["restores"], "0004");
}

// Wheels that were changed: what was once committed on this controller may come back, other values may not.
TEST_F(WayHome, what_was_once_verified_may_come_back_from_outside_of_the_band) {
  ASSERT_EQ(set_track(0.45).error, "");
  ASSERT_EQ(set_track(0.41).error, "");
  nominal_track_ = 0.36;
  restart();
  expect_refused(set_track(0.45), {"15 %", "nominal 0.36 m"});
  const auto reply = call("Rollback");
  EXPECT_EQ(reply.error, "") << reply.parameters;
  for (const char* said :
       {"verified as entry 0001", "track_width = 0.45 m is more than 15 % from the nominal 0.36 m"})
    EXPECT_NE(reply.parameters.find(said), std::string::npos) << reply.parameters;
  EXPECT_NEAR(track(), 0.45, 1e-6);
}

TEST_F(WayHome, what_was_only_found_there_may_not) {
  robot_->node().dictionary().set({0x2100, 3}, 480000);
  restart();
  ASSERT_EQ(set_track(0.41).error, "");
  expect_refused(call("Rollback"), {"track_width = 0.48 m is more than 15 %"});
  EXPECT_NEAR(track(), 0.41, 1e-6);
}

TEST_F(WayHome, a_rollback_brings_the_calibration_back_that_was_in_force_with_the_values) {
  ASSERT_EQ(apply(calibration()).error, "");
  ASSERT_EQ(call("Rollback").error, "");
  ASSERT_EQ(status()["calibrated"], false);
  ASSERT_EQ(set_track(0.41).error, "");
  ASSERT_EQ(call("Rollback").error, "");
  EXPECT_EQ(status()["calibrated"], false) << "none was in force before 0003";
  ASSERT_EQ(call("Rollback", {{"to", "0001"}}).error, "");
  EXPECT_EQ(status()["calibrated"], true);
}

TEST_F(WayHome, a_controller_that_does_not_hold_the_calibration_in_force_is_told) {
  const auto place_of_track = [](const json& parameters) {
    return parameters[2]["applied_in"].get<std::string>();
  };
  const auto now = [&] { return json::parse(call("GetParameters").parameters)["parameters"]; };
  const auto expect_told = [&](const std::string& held) {
    EXPECT_EQ(
        status()["calibration_not_held"],
        "the controller does not hold the calibration in force: track_width = " + held + " m, not 0.4033 m");
    EXPECT_NE(call("Check").parameters.find(R"("name":"calibration","outcome":"warn")"), std::string::npos);
    EXPECT_EQ(place_of_track(now()), "corrected odometry on the host; the controller holds another value");
    EXPECT_FALSE(now()[2].contains("remainder"));
    EXPECT_NE(now()[0]["applied_in"].get<std::string>().find("rounding remainder"), std::string::npos);
  };
  const auto expect_held = [&] {
    EXPECT_EQ(status()["calibration_not_held"], "");
    EXPECT_EQ(call("Check").parameters.find(R"("name":"calibration")"), std::string::npos);
    EXPECT_EQ(place_of_track(now()), "controller, rounding remainder in corrected odometry");
    EXPECT_NEAR(now()[2]["remainder"].get<double>(), 0.0, 1e-6);
  };
  ASSERT_EQ(apply(calibration()).error, "");
  expect_held();
  ASSERT_EQ(set_track(0.41).error, "");
  expect_told("0.41");
  const auto dry = apply(calibration(), {{"of_this_robot", true}, {"dry_run", true}});
  EXPECT_EQ(place_of_track(json::parse(dry.parameters)["result"]["parameters"]),
            "controller, rounding remainder in corrected odometry")
      << "what it would be";
  ASSERT_EQ(apply(calibration()).error, "");
  expect_held();
  robot_->node().dictionary().set({0x2100, 3}, 400000);  // another memory than before, while nobody looked
  restart();
  expect_told("0.4");
}

// --- A controller in the place of another ----------------------------------------------------------------

TEST_F(WayHome, a_replaced_controller_is_told_and_offered_what_was_verified_last) {
  ASSERT_EQ(set_track(0.41).error, "");
  EXPECT_EQ(status()["replaced_controller"], "");
  replace_drive(7, 480000);
  const std::string told = status()["replaced_controller"];
  for (const char* text : {"0xfee/0xd15/7", "0xfee/0xd15/4242", "entry 0001"})
    EXPECT_NE(told.find(text), std::string::npos) << told;
  const std::string checks = call("Check").parameters;
  EXPECT_NE(checks.find("odomcalibctl rollback --to 0001 --replaced"), std::string::npos) << checks;
  for (const json& wish : {json::object(), json{{"id", "0001"}}, json{{"to", "0001"}}})
    expect_refused(call("Rollback", wish), {"was it replaced?", "410.000 mm", "--to 0001 --replaced"});
  EXPECT_EQ(call("Rollback", {{"to", "0001"}, {"replaced", true}}).error, "");
  EXPECT_NEAR(track(), 0.41, 1e-6);
  EXPECT_EQ(status()["replaced_controller"], "");
  // The values that the other controller held are no way home.
  expect_refused(call("Rollback"), {"track_width = 0.48 m is more than 15 %"});
}

TEST_F(WayHome, a_calibration_of_another_controller_is_refused_by_name) {
  json foreign = calibration();
  foreign["robot"] = {{"controller_id", "0xfee/0xd15/7"}};
  expect_refused(apply(foreign), {"0xfee/0xd15/7", "0xfee/0xd15/4242", "--replaced"});
  EXPECT_EQ(apply(foreign, {{"of_this_robot", true}, {"replaced", true}}).error, "");
  foreign["robot"]["controller_id"] = "0xfee/0xd15/4242";
  EXPECT_EQ(apply(foreign).error, "");
}

// --- Whose robot -----------------------------------------------------------------------------------------

TEST_F(WayHome, without_a_name_the_daemon_says_so_and_asks_once) {
  EXPECT_NE(events_.find("robot.id is not configured"), std::string::npos) << events_;
  json body = calibration();
  body["robot"] = {{"robot_id", "robot-B"}};
  const auto plan = apply(body, {{"dry_run", true}});
  EXPECT_EQ(plan.error, "") << plan.parameters;
  const json asks = json::parse(plan.parameters)["result"]["asks"];
  ASSERT_EQ(asks.size(), 1U);
  EXPECT_NE(asks.dump().find("robot-B"), std::string::npos) << asks;
  expect_refused(apply(body, json::object()), {"robot.id is not configured", "robot-B"});
  EXPECT_EQ(apply(body, {{"of_this_robot", true}}).error, "");
  robot_id_ = "robot-B";
  events_.clear();
  restart();
  EXPECT_EQ(events_.find("robot.id"), std::string::npos) << events_;
  EXPECT_EQ(apply(body, json::object()).error, "");
}

// --- Files that no robot has made ------------------------------------------------------------------------

TEST_F(WayHome, absurd_calibrations_are_refused_with_the_member_by_name) {
  const std::vector<std::pair<const char*, json>> kAbsurd = {
      {"/parameters/track_width/unit", "km"},      {"/parameters/track_width/unit", ""},
      {"/parameters/track_width/unit", nullptr},   {"/parameters/left_wheel_diameter/std", 1e9},
      {"/parameters/track_width/std", 0.0601},  // 15 % are 60 mm
      {"/parameters/track_width/value", nullptr},  {"/effects/0/parameters/offset/unit", nullptr},
      {"/effects/0/parameters/offset/unit", "ms"}, {"/effects/0/parameters/offset/value", nullptr},
      {"/effects/0/parameters/offset/value", 1e9}, {"/effects/0/parameters/offset/std", 1e9}};
  for (const auto& [pointer, value] : kAbsurd) {
    json body = calibration();
    body[json::json_pointer(pointer)] = value;
    std::string path = std::string(pointer).substr(1);
    for (char& letter : path) letter = letter == '/' ? '.' : letter;
    if (path.starts_with("effects.0")) path.replace(0, 9, "effects.time_offset");
    expect_refused(apply(body), {"\\\"" + path + "\\\""});
  }
  for (const auto& [name, value] : {std::pair("lidar_x", 10.1), std::pair("lidar_yaw", 6.4)}) {
    json body = calibration();
    body["parameters"][name] = {
        {"value", value}, {"std", 1e-3}, {"unit", name == std::string("lidar_x") ? "m" : "rad"}};
    expect_refused(apply(body), {std::string("parameters.") + name + ".value"});
  }
  EXPECT_EQ(robot_->node().store_count(), 0U);
  json good = calibration();
  good["parameters"]["track_width"]["std"] = 0.0599;
  good["parameters"]["left_wheel_diameter"]["std"] = nullptr;  // not estimated
  good["parameters"]["lidar_x"] = {{"value", 9.9}, {"std", 1e-3}, {"unit", "m"}};
  EXPECT_EQ(apply(good).error, "");
}

// --- The journal is the history --------------------------------------------------------------------------

TEST_F(WayHome, history_knows_of_a_commit_after_which_the_daemon_was_killed) {
  ASSERT_EQ(apply(calibration()).error, "");
  const json known = history();
  // As if it had died with the record on the disk and nothing after it.
  end_service();
  std::filesystem::remove_all(folder_ / "state" / "history");
  std::filesystem::remove(folder_ / "state" / "active.json");
  start_service();
  ASSERT_TRUE(run_until([this] { return ready(); }, 20.0));
  json again = history();
  ASSERT_EQ(again.size(), 1U);
  EXPECT_NEAR(again[0]["time"].get<double>(), known[0]["time"].get<double>(), 1e6);
  again[0]["time"] = known[0]["time"];
  EXPECT_EQ(again, known);
  EXPECT_EQ(status()["calibrated"], true);
  EXPECT_TRUE(History(folder_ / "state" / "history").entries().at(0).calibration) << "on the disk, too";
  EXPECT_EQ(call("Rollback").error, "");
  EXPECT_NEAR(track(), 0.4, 1e-6);
}

TEST_F(WayHome, history_says_when_and_by_whom) {
  const double before = 1e-6 * static_cast<double>(clock_.wall_us());
  ASSERT_EQ(set_track(0.41).error, "");
  const json entry = history()[0];
  EXPECT_EQ(entry["user"], getuid());
  EXPECT_GE(1e-6 * entry["time"].get<double>(), before);
  EXPECT_LE(entry["time"].get<std::int64_t>(), clock_.wall_us());
}

// --- Proof by the daemon ---------------------------------------------------------------------------------

class ProvenByTheDaemon : public WayHome {
 protected:
  void SetUp() override {
    WayHome::SetUp();
    acquire();
    prover_ = std::make_unique<TestClient>(folder_ / "control");
  }
  void TearDown() override {
    prover_.reset();
    WayHome::TearDown();
  }
  void write_unproven() {
    prover_->call(
        "Apply",
        {{"lease", lease_}, {"calibration", calibration()}, {"of_this_robot", true}, {"prove", true}});
    ASSERT_EQ(wait_reply(*prover_, 60.0).error, "");
  }
  std::unique_ptr<TestClient> prover_;
};

TEST_F(ProvenByTheDaemon, what_nothing_was_driven_with_is_not_stored) {
  drive(0.02);
  write_unproven();
  expect_refused(call("Store"), {"nothing was stored", "were driven with these values"});
  ASSERT_EQ(call("Straight", {{"distance", 0.5}}).error, "");
  expect_refused(call("Store"), {"were driven with these values"});
  EXPECT_EQ(robot_->node().store_count(), 0U);
  EXPECT_EQ(call("Discard").error, "");
}

TEST_F(ProvenByTheDaemon, what_is_worse_is_not_stored) {
  drive(0.02);
  write_unproven();
  drive(0.03);
  expect_refused(call("Store"), {"with the new values, by"});
  EXPECT_EQ(robot_->node().store_count(), 0U);
  EXPECT_EQ(call("Discard").error, "");
}

TEST_F(ProvenByTheDaemon, what_was_not_measured_before_is_not_stored) {
  write_unproven();
  drive(0.01);
  expect_refused(call("Store"), {"with the old values was not measured"});
}

TEST_F(ProvenByTheDaemon, what_is_better_is_stored_and_called_proven) {
  drive(0.02);
  write_unproven();
  drive(0.01);
  EXPECT_EQ(call("Store").error, "");
  EXPECT_EQ(history()[0]["proven"], true);
  EXPECT_EQ(status()["proven"], true);
  ASSERT_EQ(set_track(0.41).error, "");
  EXPECT_EQ(history()[0]["proven"], false) << "nobody has driven with that";
  EXPECT_EQ(status()["proven"], false);
  ASSERT_EQ(call("Rollback").error, "");
  EXPECT_EQ(status()["proven"], true) << "what is in force again was proven";
}

}  // namespace
}  // namespace odomcalib::way_home_test
