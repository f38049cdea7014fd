// A guided motion with its recording: from the countdown until the recording is on the disk.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/safety/lease.hpp"
#include "daemon/safety/speed_watch.hpp"
#include "daemon/service/agreement.hpp"
#include "daemon/service/calibrator.hpp"
#include "daemon/service/clock.hpp"
#include "daemon/service/dead_reckoning.hpp"
#include "daemon/service/leg_report.hpp"
#include "daemon/service/loop_watch.hpp"
#include "daemon/service/motion_count.hpp"
#include "daemon/service/motion_run.hpp"
#include "daemon/service/parts/applied_calibration.hpp"
#include "daemon/service/parts/drive.hpp"
#include "daemon/service/parts/last_run.hpp"
#include "daemon/service/parts/surroundings.hpp"
#include "daemon/service/parts/write_back.hpp"
#include "daemon/service/tasks/task.hpp"
#include "daemon/service/tasks/written_recording.hpp"

namespace odomcalib {

/// Purposes of a motion, served when it has come to its end.
/// Each move by odometry and by the lidar.
struct ReportMoves {
  std::size_t moves_in_round =
      0;  ///< after so many the robot is back at its start, which is reported too; 0: never
};
/// Whether every wire goes where it should.
struct ReportWiring {
  std::function<ordered_json()> checks;  ///< rows of `check`, to which its own are added
};
struct SolveRecording {
  std::vector<std::string> effects{"auto"};
  std::vector<std::filesystem::path> earlier;  ///< recordings to be solved together with the new one
};
using MotionPurpose = std::variant<ReportMoves, ReportWiring, SolveRecording>;

class MotionTask final : public Task {
 public:
  /// A motion uses nearly everything; all of it outlives the task.
  struct Parts {
    const Config& config;
    const Clock& clock;
    const Calibrator& calibrator;
    LoopWatch& loop;
    Outbox& outbox;
    Drive& drive;
    Surroundings& surroundings;
    const DeadReckoning& odometry;
    MotionCount& recorded;
    const AppliedCalibration& applied;
    WriteBack& write_back;
    const safety::Lease& lease;
    LastRun& last_run;
  };
  struct Order {
    routines::Plan plan;
    std::string lease;
    MotionPurpose purpose;
    std::string vouched_by = {};  ///< who watches what the lidar does not see; empty: nobody
    std::string unseen = {};      ///< what that is, and which moves go there; empty: nothing
  };
  /// The robot may move; motion_gate.hpp was asked. Errors: those of Recorder::start
  static Result<std::unique_ptr<Task>> begin(const Parts& parts, const Caller& caller, Order order,
                                             double now);

  [[nodiscard]] const char* part() const override { return "motion"; }
  [[nodiscard]] std::string activity() const override;
  TaskTurn turn(double now) override;
  void stop(double now) override;
  /// Who asked for a motion and went away cannot watch it.
  void abandoned(double now) override;
  void drive_stopped(const std::string& why) override;
  void scanned(const Scan& scan) override;
  TaskTurn daemon_ends(const Error& why, double now) override;
  [[nodiscard]] bool moves() const override { return run_.has_value(); }
  [[nodiscard]] routines::Twist twist() const override { return run_ ? run_->twist() : routines::Twist{}; }

 private:
  MotionTask(const Parts& parts, const Caller& waits, Order order, double now);
  void watch_loop(double now);
  [[nodiscard]] std::optional<std::string> lapsed(double now) const;
  [[nodiscard]] Situation situation(double now) const;
  TaskTurn ended(double now);
  void begin_report();
  TaskTurn reported();
  TaskTurn written(const Result<std::filesystem::path>& path);

  const Parts parts_;
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
