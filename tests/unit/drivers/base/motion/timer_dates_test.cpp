// Frames of a drive's timer, read by a host that is sometimes held up.
#include "drivers/base/cia402/pdo_dates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace odomcalib::drivers::timer_dates_test {
namespace {

constexpr double kNominal_s = 0.020;
constexpr double kLatency_s = 0.0003;

/// Frames sent every `period`, and how much later than they were sent, and than usual, they are dated.
class Timer {
 public:
  explicit Timer(double period) : period_(period) {}
  /// @param pause s that the host does nothing before it reads the first of them
  std::vector<double> run(int frames, double pause = 0.0) {
    std::vector<double> late;
    const double reads_at = sent_ + period_ + kLatency_s + pause;
    for (int i = 0; i < frames; ++i) {
      sent_ += period_;
      late.push_back(dates_.date(std::max(sent_ + kLatency_s, reads_at)) - sent_ - kLatency_s);
    }
    return late;
  }
  void lose() { sent_ += period_; }

 private:
  double period_;
  double sent_ = 5.0;
  TimerDates dates_{kNominal_s};
};

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

class TimerPeriod : public ::testing::TestWithParam<double> {};

TEST_P(TimerPeriod, keeps_the_dates_of_what_arrives_in_time) {
  Timer timer(GetParam());
  (void)timer.run(100);
  EXPECT_LT(largest(timer.run(500)), 1e-9);
}

TEST_P(TimerPeriod, dates_what_is_read_late_by_its_beat) {
  Timer timer(GetParam());
  (void)timer.run(500);
  for (const double pause : {0.003, 0.008, 0.019, 0.027, 0.045, 0.090})
    EXPECT_LT(largest(timer.run(50, pause)), 0.0010) << pause;
}

// Crystals, and a drive whose unit of the timer is not what it says.
INSTANTIATE_TEST_SUITE_P(Timers, TimerPeriod, ::testing::Values(0.020, 0.0201, 0.01995, 0.0208));

TEST(TimerDates, find_the_beat_again_after_lost_frames) {
  Timer timer(kNominal_s);
  (void)timer.run(100);
  timer.lose();
  (void)timer.run(30);
  EXPECT_LT(largest(timer.run(100)), 0.001);
}

TEST(TimerDates, never_lie_behind_the_arrival_and_begin_anew_after_a_hole) {
  TimerDates dates(kNominal_s);
  EXPECT_EQ(dates.date(1.0), 1.0);
  EXPECT_EQ(dates.date(1.005), 1.005);
  EXPECT_EQ(dates.date(3.0), 3.0);
}

}  // namespace
}  // namespace odomcalib::drivers::timer_dates_test
