// The end of a proof that a client drove: the new values are stored, or the old ones come back.
#pragma once

#include "daemon/service/tasks/parameter_task.hpp"

namespace odomcalib {

class ProofTask final : public ParameterTask {
 public:
  /// @param proven the values that wait are stored
  ProofTask(const Caller& waits, bool proven, double now)
      : ParameterTask(waits), proven_(proven), asked_at_(now) {}

  TaskTurn turn(RobotParts& parts) override;

 private:
  TaskTurn store(RobotParts& parts);

  bool proven_;
  double asked_at_;  // s
  bool begun_ = false;
};

}  // namespace odomcalib
