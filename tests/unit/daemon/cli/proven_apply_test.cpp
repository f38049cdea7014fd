// calibrate --apply: what is written, what is proven, and what is taken back.
#include "daemon/cli/proven_apply.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <thread>

#include "daemon/cli/client.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::cli::proven_apply_test {
namespace {

using nlohmann::ordered_json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using End = ProvenApply::End;

constexpr double kTurn = 2.0 * std::numbers::pi;

ordered_json move(double distance, double yaw, double distance_error, double yaw_error) {
  return {{"lidar", {distance, 0.0, yaw}}, {"error", {{"distance", distance_error}, {"yaw", yaw_error}}}};
}

/// A daemon that notes what it was asked for, and answers as it is told.
class Daemon {
 public:
  ordered_json straight{{"moves", {move(0.5, 0.0, 0.0005, 0.0005), move(0.5, 0.0, -0.0005, -0.0005)}}};
  ordered_json spin{{"moves", ordered_json::array({move(0.0, 0.5 * kTurn, 0.0, 0.0005)})}};
  ordered_json written{{"before", {{"track_width", 0.4}}}, {"after", {{"track_width", 0.41}}}};
  std::map<std::string, Error> failures;
  std::vector<std::string> asked;

  RunMethod run() {
    return [this](const std::string& method, const ordered_json& parameters) -> Result<ordered_json> {
      asked.push_back(parameters.value("prove", false) ? method + ", to be proven" : method);
      if (failures.contains(method)) return failures.at(method);
      if (method == "Apply" || method == "Store" || method == "Discard") return written;
      return method == "Straight" ? straight : spin;
    };
  }
  ProvenApply apply(const DriveErrors& before, Verdict verdict = Verdict::accepted) {
    Calibration calibration;
    calibration.verdict = verdict;
    calibration.reasons = {"50 of 187 pairs contradict"};
    return apply_and_prove(run(), run(), calibration, before);
  }
};

const DriveErrors kOff{0.02, 0.01, 0.2};

TEST(ProvenApply, errors_are_those_of_a_metre_and_of_a_turn) {
  Daemon daemon;
  const auto errors = value_of(drive_errors(daemon.run()));
  EXPECT_NEAR(errors.straight_metre_length, 0.001, 1e-12);
  EXPECT_NEAR(errors.straight_metre_heading, 0.001, 1e-12);
  EXPECT_NEAR(errors.full_turn_heading, 0.001, 1e-12);
  EXPECT_THAT(daemon.asked, ElementsAre("Straight", "Spin"));
}

TEST(ProvenApply, a_move_that_the_lidar_did_not_see_is_no_comparison) {
  Daemon daemon;
  daemon.straight["moves"][1]["error"] = nullptr;
  const auto errors = drive_errors(daemon.run());
  ASSERT_FALSE(errors.ok());
  EXPECT_EQ(exit_status(errors.error().code), kRefused);
  EXPECT_THAT(daemon.asked, ElementsAre("Straight"));
  daemon.straight["moves"] = ordered_json::array();
  EXPECT_FALSE(drive_errors(daemon.run()).ok());
}

TEST(ProvenApply, what_is_better_stays) {
  Daemon daemon;
  const ProvenApply applied = daemon.apply(kOff);
  EXPECT_EQ(applied.end, End::stored);
  EXPECT_FALSE(applied.error);
  EXPECT_THAT(daemon.asked, ElementsAre("Apply, to be proven", "Straight", "Spin", "Store"));
  EXPECT_THAT(to_text(describe(applied)), HasSubstr("20.00"));
  EXPECT_EQ(entry_of(applied).outcome, "stored");
}

TEST(ProvenApply, what_is_worse_in_one_thing_is_taken_back) {
  for (const auto spoil : {&DriveErrors::straight_metre_length, &DriveErrors::straight_metre_heading,
                           &DriveErrors::full_turn_heading}) {
    Daemon daemon;
    daemon.straight["moves"] = ordered_json::array({move(1.0, 0.0, 0.010, 0.010)});
    daemon.spin["moves"] = ordered_json::array({move(0.0, kTurn, 0.0, 0.010)});
    DriveErrors before = kOff;
    before.*spoil = 0.009;
    const ProvenApply applied = daemon.apply(before);
    EXPECT_EQ(applied.end, End::taken_back);
    ASSERT_TRUE(applied.error);
    EXPECT_EQ(exit_status(applied.error->code), kWriteFailed);
    EXPECT_THAT(daemon.asked, ElementsAre("Apply, to be proven", "Straight", "Spin", "Discard"));
  }
}

TEST(ProvenApply, what_no_comparison_can_tell_is_not_worse) {
  EXPECT_FALSE(worse({0.0, 0.0, 0.0}, {0.0019, 0.0017, 0.0017}));
  EXPECT_THAT(worse({0.0, 0.0, 0.0}, {0.0021, 0.0, 0.0}).value_or(""), HasSubstr("length"));
  EXPECT_THAT(worse({0.0, 0.0, 0.0}, {0.0, 0.0018, 0.0}).value_or(""), HasSubstr("straight metre: heading"));
  EXPECT_THAT(worse({0.0, 0.0, 0.0}, {0.0, 0.0, 0.0018}).value_or(""), HasSubstr("full turn"));
}

TEST(ProvenApply, a_proof_run_that_was_stopped_is_none) {
  for (const char* method : {"Straight", "Spin"}) {
    Daemon daemon;
    daemon.failures[method] = {ErrorCode::protective_stop, "something is in the way", "motion", ""};
    const ProvenApply applied = daemon.apply(kOff);
    EXPECT_EQ(applied.end, End::taken_back);
    ASSERT_TRUE(applied.error);
    EXPECT_EQ(exit_status(applied.error->code), kProtectiveStop);
    EXPECT_THAT(applied.error->what, HasSubstr("old values are in force again"));
    EXPECT_EQ(daemon.asked.back(), "Discard");
  }
}

TEST(ProvenApply, what_was_not_seen_to_return_is_in_doubt) {
  Daemon daemon;
  daemon.spin["moves"] = ordered_json::array({move(0.0, kTurn, 0.0, 0.5)});
  daemon.failures["Discard"] = {ErrorCode::write_failed, "no answer", "bus", ""};
  const ProvenApply applied = daemon.apply(kOff);
  EXPECT_EQ(applied.end, End::in_doubt);
  ASSERT_TRUE(applied.error);
  EXPECT_EQ(exit_status(applied.error->code), kWriteUnknown);
  EXPECT_THAT(applied.error->what, HasSubstr("no answer"));
}

TEST(ProvenApply, a_store_that_failed_has_ended_with_the_old_values_or_says_that_it_has_not) {
  Daemon daemon;
  daemon.failures["Store"] = {ErrorCode::write_failed, "abort", "bus", ""};
  EXPECT_EQ(daemon.apply(kOff).end, End::taken_back);
  EXPECT_EQ(daemon.asked.back(), "Store");
  daemon.failures["Store"].code = ErrorCode::write_unknown;
  EXPECT_EQ(daemon.apply(kOff).end, End::in_doubt);
  EXPECT_EQ(daemon.asked.back(), "Store");
}

TEST(ProvenApply, what_was_proven_and_whose_store_did_not_begin_goes_back) {
  Daemon daemon;
  daemon.failures["Store"] = {ErrorCode::cancelled, "interrupted", "Store", "start again"};
  const ProvenApply applied = daemon.apply(kOff);
  EXPECT_EQ(applied.end, End::taken_back);
  EXPECT_EQ(daemon.asked.back(), "Discard");
}

TEST(ProvenApply, a_write_that_failed_is_not_proven) {
  Daemon daemon;
  daemon.failures["Apply"] = {ErrorCode::write_failed, "abort", "bus", ""};
  EXPECT_EQ(daemon.apply(kOff).end, End::not_stored);
  EXPECT_THAT(daemon.asked, ElementsAre("Apply, to be proven"));
  for (const ErrorCode code : {ErrorCode::write_unknown, ErrorCode::not_running, ErrorCode::io}) {
    daemon.failures["Apply"].code = code;
    EXPECT_EQ(daemon.apply(kOff).end, End::in_doubt);
  }
}

TEST(ProvenApply, a_warning_waits_for_a_person) {
  for (const Verdict verdict : {Verdict::accepted_with_warnings, Verdict::refused}) {
    Daemon daemon;
    const ProvenApply applied = daemon.apply(kOff, verdict);
    EXPECT_EQ(applied.end, End::not_stored);
    ASSERT_TRUE(applied.error);
    EXPECT_EQ(exit_status(applied.error->code), kRefused);
    EXPECT_THAT(applied.error->what, HasSubstr("50 of 187 pairs contradict"));
    EXPECT_TRUE(daemon.asked.empty());
  }
}

TEST(ProvenApply, lengths_that_stay_on_the_host_cannot_be_proven_by_the_controller) {
  ordered_json parameters = ordered_json::array();
  for (const char* name : {"left_wheel_diameter", "right_wheel_diameter", "track_width"})
    parameters.push_back({{"name", name}, {"unit", "m"}, {"stored_in", "controller"}});
  EXPECT_FALSE(unprovable(parameters));
  parameters[2]["stored_in"] = "host";
  ASSERT_TRUE(unprovable(parameters));
  EXPECT_THAT(unprovable(parameters)->what, HasSubstr("track_width"));
}

/// A daemon that hangs up on whoever calls.
class HangsUp {
 public:
  explicit HangsUp(const std::string& path) : fd_(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(std::begin(address.sun_path), sizeof(address.sun_path) - 1);
    EXPECT_EQ(bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    EXPECT_EQ(listen(fd_, 2), 0);
    thread_ = std::thread([this] {
      const int keeper = accept(fd_, nullptr, nullptr), worker = accept(fd_, nullptr, nullptr);
      close(keeper);
      close(worker);
    });
  }
  ~HangsUp() {
    thread_.join();
    close(fd_);
  }
  HangsUp(const HangsUp&) = delete;
  HangsUp& operator=(const HangsUp&) = delete;

 private:
  int fd_;
  std::thread thread_;
};

// Without the right to another priority there is none to give back.
TEST(CallWithLease, is_as_urgent_after_it_as_before) {
  const int before = sched_getscheduler(0);
  const std::string path = testing::TempDir() + "odomcalib-hangs-up-" + std::to_string(getpid());
  {
    const HangsUp daemon(path);
    const auto answer = call_with_lease(
        path, "Straight", nlohmann::ordered_json::object(), [](const auto&) {}, WhenInterrupted::stop);
    EXPECT_EQ(answer.error().code, ErrorCode::not_running);
  }
  EXPECT_EQ(sched_getscheduler(0), before);
  unlink(path.c_str());
}

TEST(CallWithLease, begins_nothing_after_ctrl_c_but_what_takes_a_write_back_back) {
  const auto end = [](WhenInterrupted interrupted) {
    return call_with_lease(
               "/nobody/listens", "Apply", nlohmann::ordered_json::object(), [](const auto&) {}, interrupted)
        .error()
        .code;
  };
  const SignalsCaught caught;
  for (const auto each : {WhenInterrupted::stop, WhenInterrupted::finish, WhenInterrupted::begin})
    EXPECT_EQ(end(each), ErrorCode::not_running);
  ASSERT_EQ(raise(SIGINT), 0);
  EXPECT_EQ(end(WhenInterrupted::stop), ErrorCode::cancelled);
  EXPECT_EQ(end(WhenInterrupted::finish), ErrorCode::cancelled);
  EXPECT_EQ(end(WhenInterrupted::begin), ErrorCode::not_running);
}

}  // namespace
}  // namespace odomcalib::cli::proven_apply_test
