// The state machine that drives a plan: (plan, state, pose, time) -> (twist, state). No I/O.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "daemon/routines/motion.hpp"

namespace odomcalib::routines {

/// Caps of one move in units of its pace.
struct Profile {
  double fastest = 0.0;
  double acceleration = 0.0;
};
Profile profile_of(const Move& move, const Limits& limits);
/// Moves that are slower than they were planned, each with its limit, once a name (rule M18).
std::vector<std::string> limited(const Plan& plan);

enum class Phase { beginning, moving, settling, done };

/// Everything a run remembers; a plain value, so that a test may copy, store and repeat it.
struct RunState {
  std::size_t move = 0;
  Phase phase = Phase::beginning;
  Pose start;              ///< where the move began
  Twist direction;         ///< of the move in progress
  double amount = 0.0;     ///< of the move in progress
  double turned = 0.0;     ///< rad since the move began, continuous over full turns
  double last_yaw = 0.0;   ///< of the last step
  double pace = 0.0;       ///< commanded
  double commanded = 0.0;  ///< m or rad since the move began
  double last_time = 0.0;
  double since = 0.0;  ///< when the phase began
};

struct Step {
  Twist twist;
  RunState state;
};

/// One control step. A pose or time that is not finite commands zero and changes nothing.
/// @param now s, not decreasing; @param pose of the odometry in the frame of the plan's start
Step next_step(const Plan& plan, RunState state, const Pose& pose, double now);

/// A plan with its state, for callers that need only the newest one.
class Runner {
 public:
  explicit Runner(Plan plan) : plan_(std::move(plan)) {}
  /// @return twist to command now; zero when done
  Twist step(double now, const Pose& pose);
  [[nodiscard]] bool done() const { return state_.phase == Phase::done || plan_.moves.empty(); }
  [[nodiscard]] const RunState& state() const { return state_; }
  [[nodiscard]] const Plan& plan() const { return plan_; }

 private:
  Plan plan_;
  RunState state_;
};

}  // namespace odomcalib::routines
