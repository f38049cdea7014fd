#include "daemon/safety/speed_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "daemon/safety/settings.hpp"

namespace odomcalib::safety {
namespace {

double allowed(double limit, double coarse) { return (1.0 + settings::kOvershoot) * limit + coarse; }

}  // namespace

void SpeedWatch::seen(double t, const routines::Pose& odometry, const routines::Twist& commanded) {
  if (!samples_.empty() && t <= samples_.back().t) return;
  samples_.push_back({t, odometry});
  while (samples_.size() > 2 && t - samples_[1].t >= settings::kSpeedWindow_s) samples_.pop_front();
  commands_.push_back({t, std::abs(commanded.v), std::abs(commanded.w)});
  while (t - commands_.front().t > settings::kSpeedWindow_s + settings::kDriveLag_s) commands_.pop_front();
}

std::optional<std::string> SpeedWatch::too_fast() const {
  if (samples_.size() < 2 || samples_.back().t - samples_.front().t < settings::kSpeedWindow_s)
    return std::nullopt;
  const auto& [begin, from] = samples_.front();
  const auto& [end, to] = samples_.back();
  const double speed = std::hypot(to.x - from.x, to.y - from.y) / (end - begin);
  const double rate = std::abs(to.yaw - from.yaw) / (end - begin);
  if (!(speed <= allowed(limits_.speed, settings::kCoarse_m_s)))
    return fmt::format("the wheels make {:.2f} m/s, {:.2f} m/s is the limit", speed, limits_.speed);
  if (!(rate <= allowed(limits_.turn_rate, settings::kCoarse_rad_s)))
    return fmt::format("the wheels make {:.2f} rad/s, {:.2f} rad/s is the limit", rate, limits_.turn_rate);
  double most_speed = 0.0, most_rate = 0.0;
  for (const Command& command : commands_) {
    most_speed = std::max(most_speed, command.speed);
    most_rate = std::max(most_rate, command.rate);
  }
  if (speed > allowed(most_speed, settings::kOffCommand_m_s))
    return fmt::format("the wheels make {:.2f} m/s, {:.2f} m/s is commanded", speed, most_speed);
  if (rate > allowed(most_rate, settings::kOffCommand_rad_s))
    return fmt::format("the wheels make {:.2f} rad/s, {:.2f} rad/s is commanded", rate, most_rate);
  return std::nullopt;
}

}  // namespace odomcalib::safety
