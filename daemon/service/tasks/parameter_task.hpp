// Common part of tasks that write to the controller: a client's stop or end does not reach them.
#pragma once

#include <string>

#include "daemon/service/calibrator.hpp"
#include "daemon/service/parts/applied_calibration.hpp"
#include "daemon/service/parts/drive.hpp"
#include "daemon/service/parts/write_back.hpp"
#include "daemon/service/tasks/task.hpp"
#include "daemon/writeback/background.hpp"

namespace odomcalib {

class ParameterTask : public Task {
 public:
  /// Parts that the tasks work on; all of them outlive the tasks.
  struct Parts {
    WriteBack& write_back;
    const Drive& drive;
    AppliedCalibration& applied;
    const Calibrator& calibrator;
    Outbox& outbox;
    Background& disk;
  };
  ParameterTask(const Parts& parts, const Caller& waits) : Task(waits), parts_(parts) {}

  [[nodiscard]] const char* part() const override { return "write-back"; }
  [[nodiscard]] std::string activity() const override { return "reading or writing parameters"; }
  /// Values are written wholly or not at all: what has begun goes on.
  void stop(double /*now*/) override {}
  void abandoned(double /*now*/) override {}

 protected:
  const Parts parts_;
};

}  // namespace odomcalib
