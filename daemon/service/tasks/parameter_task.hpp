// What tasks that write to the controller have in common: a client's stop or end does not reach them.
#pragma once

#include <string>

#include "daemon/service/tasks/task.hpp"

namespace odomcalib {

class ParameterTask : public Task {
 public:
  using Task::Task;

  [[nodiscard]] const char* part() const override { return "write-back"; }
  [[nodiscard]] std::string activity(const RobotParts& /*parts*/) const override {
    return "reading or writing parameters";
  }
  /// Values are written wholly or not at all: what has begun goes on.
  void stop(RobotParts& /*parts*/) override {}
  void abandoned(RobotParts& /*parts*/) override {}
};

}  // namespace odomcalib
