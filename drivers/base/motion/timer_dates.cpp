#include "drivers/base/motion/timer_dates.hpp"

#include <algorithm>

#include "drivers/base/motion/settings.hpp"

namespace odomcalib::drivers {

using namespace motion;

double TimerDates::date(double arrival) {
  // A frame that was lost is a whole period of lateness, to be distinguished from a host that was held up:
  // what comes after a pause of the host is soon in time again, so SampleClock gives up the old beat only
  // after a quarter of a second.
  const auto stamp = clock_.on_packet(period_s_, arrival);
  if (!stamp.continuous) {
    usual_ = 0.0;
    return arrival;
  }
  const double late = arrival - stamp.t;
  if (late > kPrompt_s) return std::min(arrival, stamp.t + usual_);
  usual_ += kGain * (late - usual_);
  return arrival;
}

}  // namespace odomcalib::drivers
