// The one thread beside the loop: what it tells while the loop looks, and when either of them ends first.
#include "daemon/service/solver_job.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "proto/control/control.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::solver_job_test {
namespace {

std::filesystem::path recording() {
  auto path = std::filesystem::path(testing::TempDir()) / ("solver_job_" + std::to_string(getpid()));
  std::ofstream(path) << R"({"type":"robot","wheel_diameter":0.1,"track_width":0.3,"ticks_per_rev":1000})"
                      << "\n"
                      << R"({"type":"ticks","t":0,"left":0,"right":0})"
                      << "\n"
                      << R"({"type":"ticks","t":1,"left":9,"right":9})"
                      << "\n";
  return path;
}

/// Tells a thousand steps and waits until it may end.
Calibrator slow(const std::shared_ptr<std::atomic<bool>>& may_end) {
  Calibrator calibrator;
  calibrator.solve = [may_end](const std::vector<std::filesystem::path>& recordings,
                               const std::vector<std::string>&,
                               const Calibrator::Progress& progress) -> Result<Calibration> {
    for (int i = 0; i < 1000; ++i) progress("step " + std::to_string(i), 1e-3 * i);
    while (!*may_end) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const auto recording = read_recording(recordings.at(0));
    if (!recording) return recording.error();
    Calibration calibration;
    calibration.robot = recording.value().robot;
    return calibration;
  };
  return calibrator;
}

std::optional<Result<Solution>> wait_for(SolverJob& job) {
  for (int i = 0; i < 30'000; ++i) {
    if (auto result = job.take_result()) return result;
    const auto [phase, fraction] = job.progress();
    EXPECT_FALSE(phase.empty());
    EXPECT_TRUE(fraction >= 0.0 && fraction <= 1.0);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return std::nullopt;
}

TEST(SolverJob, tells_its_progress_and_its_result_once) {
  const auto path = recording();
  const auto may_end = std::make_shared<std::atomic<bool>>(false);
  SolverJob job(slow(may_end), {path}, {"auto"});
  for (int i = 0; i < 10'000 && job.progress().first != "step 999"; ++i) {
    EXPECT_FALSE(job.take_result());
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(job.progress().first, "step 999");
  *may_end = true;
  const auto result = wait_for(job);
  ASSERT_TRUE(result && result->ok());
  const Solution& solution = result->value();
  const auto kept = value_of(calibration_from_json(solution.calibration, "solution"));
  EXPECT_EQ(kept.robot.track_width, 0.3);
  EXPECT_EQ(solution.line.find(path.filename().string() + ": "), 0U) << solution.line;
  control::FrameDecoder frames;
  frames.feed(solution.reply);
  const auto reply = value_of(control::decode_reply(frames.next().value_or("")));
  const auto parameters = nlohmann::json::parse(reply.parameters);
  EXPECT_EQ(parameters.at("result").at("recording"), path.string());
  EXPECT_EQ(parameters.at("result").at("calibration"), nlohmann::json::parse(solution.calibration));
  EXPECT_FALSE(job.take_result());
  std::filesystem::remove(path);
}

TEST(SolverJob, keeps_a_copy_and_tells_when_it_cannot) {
  const auto path = recording();
  const auto folder = std::filesystem::path(testing::TempDir()) / ("kept_" + std::to_string(getpid()));
  const auto may_end = std::make_shared<std::atomic<bool>>(true);
  SolverJob job(slow(may_end), {path}, {}, folder / "calibrations" / "one.json");
  ASSERT_TRUE(wait_for(job)->ok());
  EXPECT_TRUE(std::filesystem::exists(folder / "calibrations" / "one.json"));
  EXPECT_FALSE(job.not_kept());
  SolverJob failing(slow(may_end), {path}, {}, path / "below_a_file" / "one.json");
  ASSERT_TRUE(wait_for(failing)->ok());
  EXPECT_TRUE(failing.not_kept());
  std::filesystem::remove_all(folder);
  std::filesystem::remove(path);
}

TEST(SolverJob, that_throws_is_an_error_and_so_is_one_that_tells_an_error) {
  Calibrator calibrator;
  calibrator.solve = [](const auto&, const auto&, const auto&) -> Result<Calibration> {
    throw std::runtime_error("no solution");
  };
  const auto path = recording();
  SolverJob throwing(calibrator, {path}, {});
  const auto thrown = wait_for(throwing);
  ASSERT_TRUE(thrown && !thrown->ok());
  EXPECT_NE(thrown->error().text().find("no solution"), std::string::npos);
  std::filesystem::remove(path);
  SolverJob absent(slow(std::make_shared<std::atomic<bool>>(true)), {"/nonexistent"}, {});
  const auto missed = wait_for(absent);
  ASSERT_TRUE(missed && !missed->ok());
}

TEST(SolverJob, that_is_forgotten_ends_by_itself) {
  const auto path = recording();
  const auto may_end = std::make_shared<std::atomic<bool>>(false);
  {
    const SolverJob job(slow(may_end), {path}, {});
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  *may_end = true;
  for (int i = 0; i < 10'000 && may_end.use_count() > 1; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(may_end.use_count(), 1);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace odomcalib::solver_job_test
