// Selection of the samples of a running drive that are taken in.
#pragma once

#include <optional>

#include "calib/library/settings.hpp"
#include "proto/measurements.hpp"

namespace odomcalib::calib::library {

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
