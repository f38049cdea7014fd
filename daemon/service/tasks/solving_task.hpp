// From the recording of a calibration drive to the calibration.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <vector>

#include "daemon/service/solver_job.hpp"
#include "daemon/service/tasks/task.hpp"

namespace odomcalib {

class SolvingTask final : public Task {
 public:
  struct Order {
    std::vector<std::filesystem::path> recordings;  ///< solved together; the one just driven is the last
    std::vector<std::string> effects;
  };
  SolvingTask(const Bench& bench, const Caller& waits, const Order& order);

  [[nodiscard]] const char* part() const override { return "solver"; }
  [[nodiscard]] std::string activity(const Bench& /*bench*/) const override { return "solving"; }
  TaskTurn turn(Bench& bench) override;
  void stop(Bench& /*bench*/) override { *cancelled_ = true; }
  /// The result is kept in a file.
  void abandoned(Bench& /*bench*/) override {}

 private:
  std::filesystem::path recording_;
  std::shared_ptr<std::atomic<bool>> cancelled_;  // read by the thread that solves
  SolverJob job_;
};

}  // namespace odomcalib
