// From the recording of a calibration drive to the calibration.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/service/calibrator.hpp"
#include "daemon/service/solver_job.hpp"
#include "daemon/service/tasks/task.hpp"

namespace odomcalib {

class SolvingTask final : public Task {
 public:
  struct Order {
    std::vector<std::filesystem::path> recordings;  ///< solved together; the one just driven is the last
    std::vector<std::string> effects;
  };
  /// All of it outlives the task.
  struct Parts {
    Outbox& outbox;
    const Calibrator& calibrator;
    const Config& config;
  };
  SolvingTask(const Parts& parts, const Caller& waits, const Order& order);

  [[nodiscard]] const char* part() const override { return "solver"; }
  [[nodiscard]] std::string activity() const override { return "solving"; }
  TaskTurn turn(double now) override;
  void stop(double /*now*/) override { *cancelled_ = true; }
  /// The result is kept in a file.
  void abandoned(double /*now*/) override {}

 private:
  Outbox& outbox_;
  std::filesystem::path recording_;
  std::shared_ptr<std::atomic<bool>> cancelled_;  // read by the thread that solves
  SolverJob job_;
};

}  // namespace odomcalib
