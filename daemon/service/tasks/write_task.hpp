// Tasks that write to the controller.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "daemon/service/calibrator.hpp"
#include "daemon/service/parts/applied_calibration.hpp"
#include "daemon/service/parts/drive.hpp"
#include "daemon/service/parts/write_back.hpp"
#include "daemon/service/tasks/task.hpp"
#include "daemon/writeback/background.hpp"
#include "daemon/writeback/rounding.hpp"

namespace odomcalib {

/// Their common part: a client's stop or end does not reach them.
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

/// A client's write-back: new values into the controller, or what had been there before.
class WriteTask final : public ParameterTask {
 public:
  struct Order {
    std::string label;                            ///< "apply" or "rollback"
    RoundedParameters rounded;                    ///< what the controller can hold of the values
    std::optional<std::string> calibration = {};  ///< JSON text that comes into force with them
    bool replaces_calibration = true;             ///< false: the one in force stays
    bool prove = false;                           ///< they are stored when the caller has proven them
    std::string place = {};                       ///< where a rollback goes, in words
    Provenance origin = {};
  };
  /// Errors: busy while another write-back runs; io while nobody knows which entries the history has. Errors
  /// of announcing the calibration (io) and of Transaction::write end the task.
  static Result<std::unique_ptr<Task>> begin(const Parts& parts, const Caller& caller, const Order& order,
                                             double now);

  TaskTurn turn(double now) override;

 private:
  WriteTask(const Parts& parts, const Caller& waits, Order order, double now)
      : ParameterTask(parts, waits), order_(std::move(order)), asked_at_(now) {}
  void announce();
  TaskTurn begin_writing(double now);

  struct Announcement {
    std::vector<HistoryEntry> unwritten;     // that the disk did not take before
    Result<std::string> id = std::string();  // of the calibration; belongs to the disk until it is done
    bool done = false;
  };
  Order order_;
  double asked_at_;  // s
  std::shared_ptr<Announcement> announced_ = std::make_shared<Announcement>();
  bool begun_ = false;  // the transaction
};

ordered_json to_json(const RoundingError& error);

/// Answer of a write-back that has come to its end: done with the requested values, or waiting for their
/// proof.
ordered_json write_reply(const ParameterTask::Parts& parts, const WriteReport& report,
                         const ParameterMap& before, const ParameterMap& after,
                         const RoundingError& remaining);

/// The end of a write-back as the last turn of the task that waited for it.
TaskTurn turn_of(const ParameterTask::Parts& parts, const WriteEnd& end);

/// The end of a proof that a client drove: the new values are stored, or the old ones come back.
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
