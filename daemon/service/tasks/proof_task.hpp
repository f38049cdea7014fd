// The end of a proof that a client drove: the new values are stored, or the old ones come back.
#pragma once

#include <memory>
#include <string>

#include "daemon/service/tasks/task.hpp"

namespace odomcalib {

class ProofTask final : public Task {
 public:
  /// @param proven the values that wait are stored
  ProofTask(const Caller& waits, bool proven, double now) : Task(waits), proven_(proven), asked_at_(now) {}

  [[nodiscard]] const char* part() const override { return "write-back"; }
  [[nodiscard]] std::string activity(const Bench& /*bench*/) const override {
    return "reading or writing parameters";
  }
  TaskTurn turn(Bench& bench) override;
  /// Values are written wholly or not at all: what has begun goes on.
  void stop(Bench& /*bench*/) override {}
  void abandoned(Bench& /*bench*/) override {}

 private:
  TaskTurn conclude(Bench& bench);

  bool proven_;
  double asked_at_;  // s
  bool begun_ = false;
};

}  // namespace odomcalib
