// The end of a proof that a client drove: the new values are stored, or the old ones come back.
#pragma once

#include "daemon/service/tasks/parameter_task.hpp"

namespace odomcalib {

class ProofTask final : public ParameterTask {
 public:
  /// @param proven the values that wait are stored
  ProofTask(const Parts& parts, const Caller& waits, bool proven, double now)
      : ParameterTask(parts, waits), proven_(proven), asked_at_(now) {}

  TaskTurn turn(double now) override;

 private:
  TaskTurn store(double now);

  bool proven_;
  double asked_at_;  // s
  bool begun_ = false;
};

}  // namespace odomcalib
