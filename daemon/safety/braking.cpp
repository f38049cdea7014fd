#include "daemon/safety/braking.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/safety/settings.hpp"

namespace odomcalib::safety {

void Braking::begins() {
  t_.reset();
  stop_.reset();
  fastest_ = last_ = steady_ = resting_ = 0.0;
}

void Braking::seen(double t, const routines::Pose& odometry, const routines::Twist& commanded) {
  if (t_ && t <= *t_) return;
  const double dt = t_ ? t - *t_ : 0.0;
  const double way = t_ ? std::hypot(odometry.x - pose_.x, odometry.y - pose_.y) : 0.0;
  t_ = t;
  pose_ = odometry;
  const double speed = std::abs(commanded.v);
  steady_ =
      std::abs(speed - std::exchange(last_, speed)) <= settings::kFallsBy * fastest_ ? steady_ + dt : 0.0;
  // A slower move has begun, or the next one has.
  if (speed > 0.0 && steady_ >= settings::kSteady_s) fastest_ = speed;
  const bool falls = speed < (1.0 - settings::kFallsBy) * fastest_;
  if (!falls) {  // it drives on: that was no stop
    fastest_ = std::max(fastest_, speed);
    stop_.reset();
    resting_ = 0.0;
    return;
  }
  if (!stop_) stop_ = Stop{fastest_, 0.0, 0.0};
  stop_->commanded += speed * dt;
  stop_->way += way;
  resting_ = speed == 0.0 && way < settings::kRests_m_s * dt ? resting_ + dt : 0.0;
  if (resting_ < settings::kRests_s) return;
  end(*stop_);
  stop_.reset();
  fastest_ = resting_ = 0.0;
}

// A stop from a creep says little about one from a speed.
void Braking::end(const Stop& stop) {
  if (stop.speed < settings::kMeasuredFrom_m_s) return;
  overruns_.push_back(std::max(0.0, (stop.way - stop.commanded) / stop.speed));
  if (overruns_.size() > settings::kStops) overruns_.pop_front();
}

double Braking::overrun() const {
  return overruns_.empty() ? 0.0 : *std::max_element(overruns_.begin(), overruns_.end());
}

}  // namespace odomcalib::safety
