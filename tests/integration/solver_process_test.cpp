// The solver that the service starts, as a whole program.
#include "daemon/service/solver_process.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <fstream>
#include <set>
#include <stdexcept>
#include <thread>

#include "tests/integration/large_pages.hpp"
#include "tests/sim/world/simulate.hpp"
#include "tests/temporary_folder.hpp"

namespace odomcalib::solver_process_test {
namespace {

class SolverOnItsOwn : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(write_recording_jsonl(sim::standard_run(7).recording, recording_).ok());
  }

  Result<Calibration> solve(const Calibrator::Progress& progress, std::uint32_t memory = 768) {
    return solve_in_process({.program = ODOMCALIB_DAEMON, .memory = memory})({recording_}, {"none"},
                                                                             progress);
  }

  TemporaryFolder folder_;
  std::filesystem::path recording_ = folder_ / "recording.jsonl";
};

/// Process ids of the children of this one.
std::vector<pid_t> children() {
  std::vector<pid_t> all;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream file(task.path() / "children");
    for (pid_t pid = 0; file >> pid;) all.push_back(pid);
  }
  return all;
}

TEST_F(SolverOnItsOwn, gives_the_very_calibration_that_the_same_solver_gives_here) {
  std::vector<std::string> phases;
  const auto there = solve([&](const std::string& phase, double) { phases.push_back(phase); });
  ASSERT_TRUE(there.ok()) << there.error().text();
  const auto here = make_calibrator().solve({recording_}, {"none"}, {});
  ASSERT_TRUE(here.ok());
  EXPECT_EQ(to_json(there.value()), to_json(here.value()));
  ASSERT_TRUE(there.value().settings) << "a reader of the file has to know them to repeat the run";
  EXPECT_FALSE(there.value().settings->version.empty());
  EXPECT_EQ(there.value().settings->effects, std::vector<std::string>{"none"});
  EXPECT_GT(std::set<std::string>(phases.begin(), phases.end()).size(), 1U) << "it tells how far it is";
}

TEST_F(SolverOnItsOwn, has_large_pages_where_the_kernel_gives_them_on_request) {
  std::set<bool> asks;
  const auto look = [&](const std::string&, double) {
    for (const pid_t pid : children()) asks.insert(test_support::asks_for_large_pages(pid));
  };
  ASSERT_TRUE(solve(look).ok());
  EXPECT_EQ(asks, std::set{test_support::kernel_gives_large_pages_on_request()});
}

TEST_F(SolverOnItsOwn, is_gone_as_soon_as_its_progress_report_throws) {
  const auto begin = std::chrono::steady_clock::now();
  const auto stop = [](const std::string&, double) { throw std::runtime_error("stopped on request"); };
  EXPECT_THROW((void)solve(stop), std::runtime_error);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
  EXPECT_TRUE(children().empty());
}

TEST_F(SolverOnItsOwn, is_less_urgent_than_any_loop) {
  const sched_param urgent{.sched_priority = 3}, none{};
  if (sched_setscheduler(0, SCHED_RR, &urgent) != 0)
    GTEST_SKIP() << "NOT TESTED: no right to real-time priorities";
  std::set<int> policies, niceness;
  const auto look = [&](const std::string& phase, double) {
    if (phase == "reading") return;  // what it is before it has told anything
    for (const pid_t pid : children()) {
      policies.insert(sched_getscheduler(pid));
      niceness.insert(getpriority(PRIO_PROCESS, static_cast<id_t>(pid)));
    }
  };
  const auto solved = solve(look);
  ASSERT_EQ(sched_setscheduler(0, SCHED_OTHER, &none), 0);
  ASSERT_TRUE(solved.ok()) << solved.error().text();
  EXPECT_EQ(policies, std::set{SCHED_OTHER});
  EXPECT_EQ(niceness, std::set{service::settings::kLessUrgent});
}

TEST_F(SolverOnItsOwn, does_not_outlive_the_process_that_started_it) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  const pid_t service = fork();
  if (service == 0) {
    const auto tell = [&](const std::string& phase, double) {
      for (const pid_t pid : children())
        if (phase != "reading") (void)!write(ends[1], &pid, sizeof pid);
    };
    (void)solve(tell);
    _exit(0);
  }
  pid_t solver = -1;
  ASSERT_EQ(read(ends[0], &solver, sizeof solver), static_cast<ssize_t>(sizeof solver));
  // A stopped solver sends nothing: otherwise it would end when nobody receives its progress.
  ASSERT_EQ(kill(solver, SIGSTOP), 0);
  kill(service, SIGKILL);
  waitpid(service, nullptr, 0);
  // An orphan becomes somebody else's child, who may let it lie: a process in state Z has ended.
  const auto ended = [solver] {
    std::ifstream file("/proc/" + std::to_string(solver) + "/stat");
    std::string id, name, state;
    return !(file >> id >> name >> state) || state == "Z";
  };
  for (int i = 0; i < 2000 && !ended(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_TRUE(ended());
  kill(solver, SIGKILL);
  for (const int end : ends) close(end);
}

TEST_F(SolverOnItsOwn, that_is_killed_is_an_error_that_says_so) {
  const auto kill_it = [](const std::string&, double) {
    for (const pid_t pid : children()) kill(pid, SIGKILL);
  };
  const auto result = solve(kill_it);
  ASSERT_FALSE(result.ok());
  EXPECT_NE(result.error().what.find("signal 9"), std::string::npos) << result.error().text();
}

TEST_F(SolverOnItsOwn, tells_what_the_solver_tells_of_a_recording_that_is_not_there) {
  recording_ = folder_ / "absent.jsonl";
  const auto result = solve({});
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::io);
  EXPECT_NE(result.error().text().find("absent.jsonl"), std::string::npos) << result.error().text();
}

TEST_F(SolverOnItsOwn, that_would_need_more_memory_than_it_may_have_says_what_to_do) {
#if defined(ODOMCALIB_SANITIZED)
  GTEST_SKIP() << "sanitizers take the memory themselves";
#endif
  const auto result = solve({}, 8);
  ASSERT_FALSE(result.ok());
  EXPECT_NE(result.error().text().find("8 MiB"), std::string::npos) << result.error().text();
  EXPECT_NE(result.error().remedy.find("odomcalibctl solve"), std::string::npos) << result.error().text();
}

TEST(SolverProcess, that_cannot_be_started_is_an_error) {
  const auto result = solve_in_process({.program = "/nonexistent"})({"recording"}, {}, {});
  ASSERT_FALSE(result.ok());
  EXPECT_NE(result.error().what.find("cannot start"), std::string::npos) << result.error().text();
}

}  // namespace
}  // namespace odomcalib::solver_process_test
