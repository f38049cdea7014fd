#include "calib/odometry/odometry.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "calib/odometry/settings.hpp"
#include "calib/vehicle/drive_history.hpp"
#include "calib/vehicle/step_context.hpp"
#include "calib/wheels/wheel_track.hpp"

namespace odomcalib::calib::odometry {
namespace {

double tick_angle_of(const RobotDescription& robot) {
  return robot.ticks_per_rev > 0.0 ? 2.0 * math::kPi / robot.ticks_per_rev : 0.0;
}

/// Dead reckoning and what it remembers of the drive so far.
struct Course {
  Course(const Calibration& calibration, bool time_is_known)
      : reckoning(correction_of(calibration, time_is_known)),
        groups(covariates_of(reckoning.correction().effects)),
        history(reckoning.base(), tick_angle_of(calibration.robot), groups) {}

  DeadReckoning reckoning;
  vehicle::CovariateGroups groups;  ///< that the correction looks at
  vehicle::DriveHistory history;
};

void forget_first(wheels::WheelTrack& track) {
  track.t.erase(track.t.begin());
  track.left.erase(track.left.begin());
  track.right.erase(track.right.begin());
  track.segment.erase(track.segment.begin());
}

void forget_all(wheels::WheelTrack& track) {
  track.t.clear();
  track.left.clear();
  track.right.clear();
  track.segment.clear();
}

void reserve(wheels::WheelTrack& track, std::size_t count) {
  track.t.reserve(count);
  track.left.reserve(count);
  track.right.reserve(count);
  track.segment.reserve(count);
}

}  // namespace

struct Odometry::State {
  explicit State(const Calibration& calibration)
      : clock(calibration),
        ticks_per_rev(calibration.robot.ticks_per_rev),
        usual(calibration, false),
        of_time(calibration, true) {
    reserve(recent, settings::kHistory + 1);
    recent.tick_angle = tick_angle_of(calibration.robot);
    contexts.resize(2);
  }

  [[nodiscard]] Course& course() { return clock.is_known() ? of_time : usual; }

  DriveClock clock;
  double ticks_per_rev;
  Course usual, of_time;  ///< which of them, the stamp of the first sample says
  std::optional<wheels::TickAngles> angles;
  double begin = 0.0;  ///< s, of the drive
  wheels::WheelTrack recent;
  std::vector<vehicle::StepContext> contexts;  ///< of the last intervals; the last one was added
  double duration = 0.0;
};

Odometry::Odometry(const Calibration& calibration) : state_(std::make_unique<State>(calibration)) {}
Odometry::~Odometry() = default;
Odometry::Odometry(Odometry&&) noexcept = default;
Odometry& Odometry::operator=(Odometry&&) noexcept = default;

double Odometry::duration() const { return state_->duration; }
const vehicle::StepContext& Odometry::interval() const { return state_->contexts.back(); }
const DeadReckoning& Odometry::reckoning() const { return state_->course().reckoning; }

void Odometry::take_back() { state_->course().reckoning.take_back(); }
bool Odometry::has_samples() const { return !state_->recent.t.empty(); }
bool Odometry::knows_time() const { return state_->clock.is_known(); }
void Odometry::forget_samples() { forget_all(state_->recent); }

namespace {

/// How far the wheels turned in the last interval, which is all that a plain model asks for.
void look_at_wheels(const wheels::WheelTrack& track, vehicle::StepContext& interval) {
  const std::size_t last = track.t.size() - 1;
  const bool joined = track.segment[last - 1] == track.segment[last];
  interval.dt = track.t[last] - track.t[last - 1];
  interval.left_delta = joined ? track.left[last] - track.left[last - 1] : 0.0;
  interval.right_delta = joined ? track.right[last] - track.right[last - 1] : 0.0;
}

/// The last interval, seen with the history before it; what accumulates over the whole drive is carried
/// along.
void look_at_all(const wheels::WheelTrack& track, Course& course,
                 std::vector<vehicle::StepContext>& contexts) {
  const std::size_t n = track.t.size();
  const wheels::BaseParameters base = course.reckoning.base();
  make_context_of_moment(track, base, course.groups, n - std::min<std::size_t>(n, 3), contexts);
  fill_past_covariates(contexts.back(), track, base, course.groups);
  course.history.advance(contexts.back());
}

PoseSample at(double stamp, const math::Pose& pose) {
  return {stamp, pose.x, pose.y, math::wrap_angle(pose.yaw)};
}

}  // namespace

PoseSample Odometry::update(const TickSample& sample) {
  State& s = *state_;
  if (!s.angles) {
    s.clock.start(sample.t);
    s.begin = sample.t;
    s.angles.emplace(sample, s.ticks_per_rev);
  }
  Course& course = s.course();
  const bool is_first = s.recent.t.empty();
  const bool advances = !is_first && sample.t > s.recent.t.back();
  if (is_first || advances) s.angles->append(sample, s.recent);
  if (s.recent.t.size() > settings::kHistory) forget_first(s.recent);
  if (!advances || !(s.ticks_per_rev > 0.0)) return at(sample.t, course.reckoning.pose());

  if (course.reckoning.is_plain())
    look_at_wheels(s.recent, s.contexts.back());
  else
    look_at_all(s.recent, course, s.contexts);
  vehicle::StepContext& interval = s.contexts.back();
  const std::size_t last = s.recent.t.size() - 1;
  interval.t = s.clock.at(s.begin + ((s.recent.t[last - 1] + s.recent.t[last]) / 2.0 - s.begin));
  s.duration = interval.dt;
  course.reckoning.advance(interval);
  return at(sample.t, course.reckoning.pose());
}

}  // namespace odomcalib::calib::odometry
