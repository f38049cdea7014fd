// One guided motion from consent to rest: countdown, enable, stand, drive the plan, stand, stop. The stop is
// a guard: whatever ends the run, its destruction included, commands zero, a quick stop and no torque.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "daemon/routines/runner.hpp"
#include "daemon/safety/envelope.hpp"
#include "daemon/safety/stop_guard.hpp"
#include "drivers/base/controller.hpp"

namespace odomcalib {

/// One move of the plan with what was measured at rest before and after it.
struct Leg {
  routines::Move move;
  double begin = 0.0, end = 0.0;  ///< s
  routines::Pose before, after;   ///< in the odometry frame
  TickSample ticks_before, ticks_after;
  std::optional<Scan> scan_before, scan_after;
  std::vector<Scan> scans_before, scans_after;  ///< a few, all of them taken at rest, oldest first
};

/// State of the world at one control step.
struct Situation {
  double now = 0.0;
  routines::Pose odometry;
  TickSample ticks;
  std::optional<std::string> lapsed = "there is no lease";  ///< why the client does not count as present
  std::optional<std::string> stale;                         ///< why sensors block motion
  std::optional<std::string> disagreement;                  ///< between odometry and lidar
  routines::Pose by_lidar;                                  ///< motion since the drive began, yaw continuous
  std::optional<std::string> too_fast;                      ///< what was measured, not what was commanded
  std::optional<std::string> obstacle;                      ///< in the way
};

class MotionRun {
 public:
  enum class Phase { countdown, enabling, standing, driving, resting, done, stopped };

  struct Options {
    routines::Plan plan;
    routines::WheelGeometry geometry;
    double countdown = 3.0;  ///< s
    double now = 0.0;
    std::function<void()> flush;  ///< brings the controller's frames onto the bus at once
  };

  MotionRun(Options options, drivers::Controller& controller);
  /// The newest scan; used as the picture at rest.
  void seen(const Scan& scan);
  /// A stop event of the controller.
  void fault(const std::string& text);
  /// At least every 20 ms.
  void step(const Situation& situation);
  /// Ends the run now.
  void stop(const Error& why);

  [[nodiscard]] Phase phase() const { return phase_; }
  [[nodiscard]] bool ended() const { return phase_ == Phase::done || phase_ == Phase::stopped; }
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }
  [[nodiscard]] const std::vector<Leg>& legs() const { return legs_; }
  [[nodiscard]] const routines::Twist& twist() const { return twist_; }
  [[nodiscard]] bool driving() const { return phase_ == Phase::driving; }
  /// Name of the phase, or of the move.
  [[nodiscard]] std::string activity() const;
  /// Remaining time of the drive, s, as it was planned.
  [[nodiscard]] double remaining() const;
  /// Elapsed share of the drive's planned time, in [0, 1].
  [[nodiscard]] double fraction() const;

 private:
  void check(const Situation& situation);
  void advance(const Situation& situation);
  void drive(const Situation& situation);
  void note_legs(const routines::RunState& before, const Situation& situation);
  void command(const routines::Twist& twist, double now);
  void enter(Phase phase, double now);
  void finish(Phase phase);

  Options options_;
  drivers::Controller& controller_;
  routines::Runner runner_;
  routines::Preview preview_;
  safety::Envelope envelope_;
  Phase phase_ = Phase::countdown;
  double since_ = 0.0, now_ = 0.0, drive_began_ = 0.0;
  routines::Pose start_;  // in the odometry frame, where the plan begins
  routines::Twist twist_;
  std::optional<Scan> scan_;
  std::vector<Scan> at_rest_;  // since the robot came to rest
  double moved_at_ = 0.0;      // s, when it was last commanded to move
  std::vector<Leg> legs_;
  std::optional<Error> error_;
  safety::StopGuard guard_;  // last: destroyed first, while everything it uses still exists
};

std::string name_of(MotionRun::Phase phase);

}  // namespace odomcalib
