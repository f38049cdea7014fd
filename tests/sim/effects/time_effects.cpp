// Stamps that are not the time of measurement.
#include <cmath>

#include "tests/sim/effects/effect.hpp"

namespace odomcalib::sim {

namespace {

/// A sweep waits in a queue before it gets its stamp: a fixed way plus a varying wait.
class SweepQueue : public Effect {
 public:
  SweepQueue(double delay, Random& random) : Effect("sweep_queue", delay), random_(random()) {}
  void on_scan(ScanStamp& scan) override {
    if (size_ <= 0.0) return;
    scan.stamp += size_ * (0.95 + std::exponential_distribution<double>(1.0 / 0.05)(random_));
  }

 private:
  Random random_;
};

/// Counter samples wait for the next free slot of a slow poll, all with the same way in front.
class CountQueue : public Effect {
 public:
  CountQueue(double delay, Random& random)
      : Effect("count_queue", delay), phase_(uniform(random, 0.0, kSlot)) {}
  void on_ticks(TickReading& reading) override {
    if (size_ <= 0.0) return;
    const double ready = reading.stamp + size_;
    reading.stamp = std::ceil((ready - phase_) / kSlot) * kSlot + phase_;
  }

 private:
  static constexpr double kSlot = 0.003;  // s
  double phase_;
};

/// The lidar's crystal runs off, more at first while it is cold.
class CrystalDrift : public Effect {
 public:
  CrystalDrift(double rate, Random& random) : Effect("crystal_drift", rate), way_(any_sign(random)) {}
  void on_scan(ScanStamp& scan) override {
    constexpr double kWarmUp = 40.0;  // s
    scan.stamp += way_ * size_ * (scan.t + 0.5 * kWarmUp * (1.0 - std::exp(-scan.t / kWarmUp)));
  }

 private:
  double way_;
};

template <typename Kind>
auto time_maker() {
  return [](double size, Random& random) -> std::shared_ptr<Disturbance> {
    return std::make_shared<Kind>(size, random);
  };
}

}  // namespace

std::vector<EffectKind> time_effects() {
  return {
      {"sweep_queue", "time_offset", {"acceleration"}, "s", 0.01, 0.08, time_maker<SweepQueue>()},
      {"count_queue", "time_offset", {"acceleration"}, "s", 0.01, 0.06, time_maker<CountQueue>()},
      {"crystal_drift",
       "clock_drift",
       {"time", "acceleration"},
       "s/s",
       0.0001,
       0.001,
       time_maker<CrystalDrift>()},
  };
}

}  // namespace odomcalib::sim
