// A client's write-back: new values into the controller, or what had been there before.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "daemon/service/tasks/parameter_task.hpp"
#include "daemon/writeback/rounding.hpp"

namespace odomcalib {

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
  /// Error: refused while another write-back runs. Errors of announcing the calibration (io) and of
  /// Transaction::write end the task.
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

}  // namespace odomcalib
