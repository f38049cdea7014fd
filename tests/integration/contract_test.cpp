// Promises of the service to whoever runs it: what it writes to the journal and to the state directory, and
// what it does where that is read-only or taken, the configuration is edited, or the clock is set.
#include <fstream>

#include "tests/integration/service_loop.hpp"

namespace odomcalib::contract_test {
namespace {

struct Line {
  messages::Severity severity = messages::Severity::info;
  std::string code, text;
};

class Contract : public ServiceLoop {
 protected:
  using ServiceLoop::adjust;
  EventLog log() override {
    return [this](auto severity, const auto& code, const auto& text) {
      lines_.push_back({severity, code, text});
    };
  }
  /// The first line of that kind that contains the text; nullptr: none.
  const Line* logged(const std::string& code, const std::string& text) const {
    const auto found = std::find_if(lines_.begin(), lines_.end(), [&](const Line& line) {
      return line.code == code && line.text.find(text) != std::string::npos;
    });
    return found == lines_.end() ? nullptr : &*found;
  }
  std::string all_lines() const {
    std::string all;
    for (const Line& line : lines_) all += line.code + ": " + line.text + "\n";
    return all;
  }
  json check_named(const std::string& name) {
    const json reply = json::parse(ask("Check", json::object(), 1.0).parameters);
    for (const auto& check : reply["checks"])
      if (check["name"] == name) return check;
    return {};
  }
  void straight(double distance, const std::string& error) {
    const auto reply = ask("Straight", {{"lease", lease_}, {"distance", distance}}, 30.0);
    EXPECT_EQ(reply.error, error) << reply.parameters;
  }

  std::vector<Line> lines_;
};

TEST_F(Contract, journal_names_devices_motions_who_asked_and_why_it_stopped) {
  EXPECT_TRUE(logged("bus", "is connected")) << all_lines();
  EXPECT_TRUE(logged("lidar", "is connected")) << all_lines();
  acquire();
  straight(0.3, "");
  const std::string who = "user " + std::to_string(getuid()) + ", process " + std::to_string(getpid());
  EXPECT_TRUE(logged("motion", "straight begins, for " + who)) << all_lines();
  EXPECT_TRUE(logged("motion", "motion finished")) << all_lines();
  Mover mover(*this);
  robot_->unplug_lidar();
  EXPECT_EQ(wait_reply(mover, 3.0).error, "org.odomcalib.Calibration.ProtectiveStop");
  const Line* lost = logged("lidar", "is lost");
  ASSERT_TRUE(lost) << all_lines();
  EXPECT_EQ(lost->severity, messages::Severity::warning);
  const Line* stopped = logged("stopped", "scan");
  ASSERT_TRUE(stopped) << all_lines();
  EXPECT_EQ(stopped->severity, messages::Severity::stop);
}

TEST_F(Contract, check_does_not_blame_the_profile_for_a_controller_that_is_away) {
  EXPECT_EQ(check_named("watchdog")["outcome"], "ok");
  robot_->cut_can(true);
  ASSERT_TRUE(run_until([&] { return status()["controller"]["state"] == "absent"; }, 5.0));
  const json watchdog = check_named("watchdog");
  EXPECT_EQ(watchdog["outcome"], "fail");
  EXPECT_EQ(watchdog["found"], "not known: the controller is absent");
}

TEST_F(Contract, journal_names_write_backs_and_their_ends) {
  acquire();
  EXPECT_EQ(ask("SetParameters", {{"lease", lease_}, {"values", {{"track_width", 0.4033}}}}, 20.0).error, "");
  EXPECT_TRUE(logged("write_back", "begins, for user")) << all_lines();
  EXPECT_TRUE(logged("write_back", "committed")) << all_lines();
}

TEST_F(Contract, journal_is_not_filled_by_a_device_that_comes_and_goes) {
  for (int i = 0; i < 60; ++i) {
    robot_->unplug_lidar();
    run(0.3);
    ASSERT_TRUE(robot_->plug_lidar().ok());
    run(0.9);
  }
  const auto about_lidar =
      std::count_if(lines_.begin(), lines_.end(), [](const Line& l) { return l.code == "lidar"; });
  EXPECT_GT(about_lidar, 10);
  EXPECT_LT(about_lidar, 45) << all_lines();
  EXPECT_TRUE(logged("lidar", "more that are left out")) << all_lines();
}

TEST_F(Contract, state_directory_is_for_one_daemon) {
  Config other = configuration();
  other.socket = folder_ / "other";
  const auto second = Service::create(other, clock_, {});
  ASSERT_FALSE(second.ok());
  EXPECT_NE(second.error().what.find("another daemon uses this state directory"), std::string::npos)
      << second.error().text();
  other.state_dir = folder_ / "elsewhere";
  EXPECT_TRUE(Service::create(other, clock_, {}).ok());
}

TEST_F(Contract, why_the_robot_was_stopped_is_known_after_a_restart) {
  acquire();
  Mover mover(*this);
  robot_->unplug_lidar();
  (void)wait_reply(mover, 3.0);
  const std::string why = status()["last_stop"];
  ASSERT_NE(why, "");
  ASSERT_TRUE(robot_->plug_lidar().ok());
  end_service();
  start_service();
  ASSERT_TRUE(service_);
  EXPECT_EQ(status()["last_stop"], why);
  EXPECT_FALSE(logged("restarted", "")) << all_lines();
}

TEST_F(Contract, F33_a_wall_clock_that_is_set_disturbs_no_motion) {
  acquire();
  for (const double step : {10.0, -20.0}) {
    Mover mover(*this);
    clock_.wall_step += step;
    const auto reply = wait_reply(mover, 30.0);
    EXPECT_EQ(reply.error, "") << step << " s: " << reply.parameters;
  }
  EXPECT_EQ(status()["last_stop"], "");
}

class EditedConfig : public Contract {
 protected:
  using Contract::adjust;
  void adjust(Config& config) override {
    config.file = folder_ / "odomcalib.toml";
    if (!std::filesystem::exists(config.file)) std::ofstream(config.file) << "# as it was\n";
    config.written = std::filesystem::last_write_time(config.file);
  }
};

TEST_F(EditedConfig, F40_in_motion_changes_nothing_before_the_next_start_and_check_says_so) {
  EXPECT_EQ(check_named("configuration")["outcome"], "ok");
  acquire();
  Mover mover(*this);
  std::ofstream(folder_ / "odomcalib.toml") << "[limits]\nspeed = nonsense\n";
  std::filesystem::last_write_time(folder_ / "odomcalib.toml",
                                   std::filesystem::file_time_type::clock::now() + std::chrono::seconds(5));
  const auto reply = wait_reply(mover, 30.0);
  EXPECT_EQ(reply.error, "") << reply.parameters;
  const json found = check_named("configuration");
  EXPECT_EQ(found["outcome"], "warn") << found;
  std::filesystem::remove(folder_ / "odomcalib.toml");
  EXPECT_EQ(check_named("configuration")["outcome"], "warn");
}

class ReadOnlyState : public Contract {
 protected:
  using Contract::adjust;
  // Root may write anywhere but below a file.
  void adjust(Config& config) override {
    std::ofstream(folder_ / "file") << "in the way";
    config.state_dir = folder_ / "file" / "state";
  }
};

TEST_F(ReadOnlyState, F35_the_service_runs_says_so_and_neither_moves_nor_writes) {
  EXPECT_TRUE(logged("read_only", "nothing can be written")) << all_lines();
  EXPECT_EQ(check_named("disk")["outcome"], "fail");
  acquire();
  straight(0.3, "org.odomcalib.Calibration.Io");
  EXPECT_LT(robot_->fastest_rim(), 1e-6);
  const auto stored = robot_->node().geometry_stored(), held = robot_->node().geometry_in_ram();
  EXPECT_NE(ask("SetParameters", {{"lease", lease_}, {"values", {{"track_width", 0.4033}}}}, 5.0).error, "");
  EXPECT_EQ(robot_->node().geometry_stored(), stored);
  EXPECT_EQ(robot_->node().geometry_in_ram(), held);
  EXPECT_EQ(status()["state"], "idle");
}

class WithWrongLcmUrl : public Contract {
  void adjust(Config& config) override {
    config.lcm_enabled = true;
    config.lcm_url = "udpm://1.2.3.4:7667";  // no multicast address
  }
};

TEST_F(WithWrongLcmUrl, the_journal_names_the_key_once) {
  EXPECT_TRUE(
      run_until([this] { return logged("lcm", R"(lcm.url = "udpm://1.2.3.4:7667")") != nullptr; }, 60.0));
  run(10.0);
  EXPECT_EQ(std::count_if(lines_.begin(), lines_.end(), [](const Line& line) { return line.code == "lcm"; }),
            1)
      << all_lines();
}

}  // namespace
}  // namespace odomcalib::contract_test
