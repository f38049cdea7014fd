// Wheel motion of every kind as counts that go on, and which samples of a running drive are taken in.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "calib/library/settings.hpp"
#include "proto/measurements.hpp"

namespace odomcalib::calib::library {

/// The data that a drive takes its motion from.
enum class Motion { none, counts, angles, speeds };

/// Cumulative counts of both wheels.
using Counts = std::array<std::int64_t, 2>;

/// Counts that wrap at a number of bits, continued.
class CounterWrap {
 public:
  /// @param bits 0: they do not wrap
  explicit CounterWrap(int bits) : bits_(bits) {}
  Counts operator()(const Counts& raw);
  void restart() { last_raw_.reset(); }

 private:
  int bits_;
  std::optional<Counts> last_raw_;
  Counts total_{};
};

/// Angles as counts of the encoder's grid, which need not go through zero: what counts are the differences.
class AngleCounts {
 public:
  explicit AngleCounts(double counts_per_turn) : counts_per_turn_(counts_per_turn) {}
  /// @param angles rad
  /// @return nullopt beyond what can be counted
  std::optional<Counts> operator()(const std::array<double, 2>& angles);
  void restart() { first_.reset(); }

 private:
  double counts_per_turn_;
  std::optional<std::array<double, 2>> first_;
};

/// Speeds, each held until the next.
class SpeedCounts {
 public:
  explicit SpeedCounts(double counts_per_turn) : counts_per_turn_(counts_per_turn) {}
  /// Counts at a stamp, when these speeds begin. Changes nothing until keep().
  /// @param speeds rad/s
  std::optional<Counts> at(double stamp, const std::array<double, 2>& speeds);
  void keep();
  void restart() { last_.reset(); }

 private:
  struct Held {
    double stamp;
    std::array<double, 2> speeds, angles;
  };
  double counts_per_turn_;
  std::optional<Held> last_, next_;
};

enum class Admission {
  goes_on,    ///< follows the last one that was taken in
  anew,       ///< follows the one that was rejected before it: counter or clock go on from there
  not_later,  ///< rejected for its stamp
  jump,       ///< rejected for its counts
};

/// A sample that does not follow the last one is rejected, and remembered: when the next one follows that,
/// the counter was reset; when it follows the last one that was taken in, the sample was read wrong.
class SampleGate {
 public:
  /// @param metres_per_count of the larger wheel
  explicit SampleGate(double metres_per_count) : metres_per_count_(metres_per_count) {}

  Admission admit(const TickSample& sample);
  /// The sample that `anew` goes on from.
  [[nodiscard]] const TickSample& begin() const { return begin_; }
  /// The last sample that was taken in; its counts are not those of the next one to compare with, after
  /// restart().
  [[nodiscard]] const std::optional<TickSample>& last() const { return last_; }
  void restart();

 private:
  [[nodiscard]] bool follows(const TickSample& from, const TickSample& to) const;
  void take(const TickSample& sample);

  double metres_per_count_;
  double usual_interval_ = settings::kUsualInterval_s;
  std::optional<TickSample> last_, rejected_;
  TickSample begin_;
};

}  // namespace odomcalib::calib::library
