// A guided motion with its recording: from the countdown until the recording is on the disk.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "daemon/safety/speed_watch.hpp"
#include "daemon/service/agreement.hpp"
#include "daemon/service/leg_report.hpp"
#include "daemon/service/motion_run.hpp"
#include "daemon/service/tasks/task.hpp"
#include "daemon/service/tasks/written_recording.hpp"

namespace odomcalib {

/// What is made of a motion when it has come to its end.
/// Each move by odometry and by the lidar.
struct ReportMoves {
  std::size_t moves_in_round =
      0;  ///< after so many the robot is back at its start, which is reported too; 0: never
};
struct ReportWiring {};  ///< whether every wire goes where it should
struct SolveRecording {
  std::vector<std::string> effects{"auto"};
  std::vector<std::filesystem::path> earlier;  ///< recordings to be solved together with the new one
};
using MotionPurpose = std::variant<ReportMoves, ReportWiring, SolveRecording>;

class MotionTask final : public Task {
 public:
  struct Order {
    routines::Plan plan;
    std::string lease;
    MotionPurpose purpose;
    std::string vouched_by = {};  ///< who watches what the lidar does not see; empty: nobody
    std::string unseen = {};      ///< what that is, and which moves go there; empty: nothing
  };
  /// The robot may move; motion_gate.hpp was asked. Errors: those of Recorder::start
  static Result<std::unique_ptr<Task>> begin(RobotParts& parts, const Caller& caller, Order order);

  [[nodiscard]] const char* part() const override { return "motion"; }
  [[nodiscard]] std::string activity(const RobotParts& parts) const override;
  TaskTurn turn(RobotParts& parts) override;
  void stop(RobotParts& parts) override;
  /// Who asked for a motion and went away cannot watch it.
  void abandoned(RobotParts& parts) override;
  void drive_stopped(const std::string& why) override;
  void scanned(const RobotParts& parts, const Scan& scan) override;
  TaskTurn daemon_ends(RobotParts& parts, const Error& why) override;
  [[nodiscard]] bool moves() const override { return run_.has_value(); }
  [[nodiscard]] routines::Twist twist() const override { return run_ ? run_->twist() : routines::Twist{}; }

 private:
  MotionTask(RobotParts& parts, const Caller& waits, Order order);
  void watch_loop(RobotParts& parts);
  [[nodiscard]] std::optional<std::string> lapsed(const RobotParts& parts) const;
  [[nodiscard]] Situation situation(const RobotParts& parts) const;
  TaskTurn ended(RobotParts& parts);
  void begin_report(const RobotParts& parts);
  TaskTurn reported(RobotParts& parts);
  TaskTurn written(const RobotParts& parts, const Result<std::filesystem::path>& path);

  std::string lease_;
  MotionPurpose purpose_;
  std::vector<std::string> limited_;
  AgreementWatch agreement_;
  safety::SpeedWatch speed_;
  std::optional<MotionRun> run_;      // until it has ended
  std::optional<MovesReport> moves_;  // while its scans are compared
  ordered_json report_;               // of the motion, while its recording goes to the disk
  WrittenRecording written_;
  double next_step_ = 0.0;     // s
  double stepped_at_ = 0.0;    // s, last control step
  double suspended_at_ = 0.0;  // s, Clock::suspended() then
};

}  // namespace odomcalib
