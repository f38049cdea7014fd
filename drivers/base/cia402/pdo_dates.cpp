#include "drivers/base/cia402/pdo_dates.hpp"

#include <algorithm>

#include "drivers/base/cia402/settings.hpp"
#include "drivers/base/motion/settings.hpp"

namespace odomcalib::drivers {
namespace {

constexpr std::uint8_t kMostSyncs = 240;  // transmission types 1..240: every n-th SYNC
constexpr std::uint8_t kOnEvent = 254;    // 254, 255: on change or timer

/// s. Bits of a standard frame without stuffing, with its inter-frame space.
double frame_time(const CanFrame& frame, double bitrate) { return (47.0 + 8.0 * frame.length) / bitrate; }

}  // namespace

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

double PdoDates::date(const canopen::Pdo& pdo, const CanFrame& frame) {
  const bool on_sync = pdo.type >= 1 && pdo.type <= kMostSyncs;
  if (on_sync && sync_at_ && frame.t - *sync_at_ < cia402::kSyncLives_s) return *sync_at_;
  const double began = frame.t - frame_time(frame, bitrate_);
  const unsigned timer = pdo.type >= kOnEvent ? pdo.event_timer.value_or(0) : 0;
  if (timer == 0) return began;
  if (!timer_) timer_.emplace(timer_unit_s_ * timer);
  return timer_->date(began);
}

}  // namespace odomcalib::drivers
