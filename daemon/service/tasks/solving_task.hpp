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
  SolvingTask(const RobotParts& parts, const Caller& waits, const Order& order);

  [[nodiscard]] const char* part() const override { return "solver"; }
  [[nodiscard]] std::string activity(const RobotParts& /*parts*/) const override { return "solving"; }
  TaskTurn turn(RobotParts& parts) override;
  void stop(RobotParts& /*parts*/) override { *cancelled_ = true; }
  /// The result is kept in a file.
  void abandoned(RobotParts& /*parts*/) override {}

 private:
  std::filesystem::path recording_;
  std::shared_ptr<std::atomic<bool>> cancelled_;  // read by the thread that solves
  SolverJob job_;
};

}  // namespace odomcalib
