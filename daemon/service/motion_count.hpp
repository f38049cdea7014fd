// Amount of each kind of motion in a recording, while it is made: whether a solve makes sense yet.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "proto/measurements.hpp"

namespace odomcalib {

class MotionCount {
 public:
  struct Kind {
    std::size_t stretches = 0;  ///< each as long as a pair of scans that a solve compares
    double amount = 0.0;        ///< m driven straight, rad turned
  };

  /// Adds the motion since the last sample, by nominal dimensions; a new segment or unknown ones add none.
  void add(const TickSample& sample, const RobotDescription& robot);

  [[nodiscard]] const Kind& straight() const { return straight_; }
  [[nodiscard]] const Kind& left() const { return left_; }
  [[nodiscard]] const Kind& right() const { return right_; }
  /// Missing requirements of the classical methods, as a sentence each; empty when there are none.
  [[nodiscard]] std::vector<std::string> missing() const;

 private:
  void end_stretch();

  std::optional<TickSample> last_;
  double distance_ = 0.0, turn_ = 0.0;  ///< m and rad, of the stretch that goes on
  Kind straight_, left_, right_;
};

}  // namespace odomcalib
