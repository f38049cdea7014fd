// Gathers the beams of a spinning lidar into turns.
#pragma once

#include <cstdint>
#include <vector>

#include "drivers/can/transport.hpp"  // Counters
#include "drivers/lidar/lidar.hpp"

namespace odomcalib::drivers {

/// One beam with its own time and direction.
struct Beam {
  double t = 0.0;      ///< s
  double angle = 0.0;  ///< rad in the sensor's frame, counter-clockwise positive
  double range = 0.0;  ///< m, 0 = no reading
  double intensity = 0.0;
};

class Sweep {
 public:
  struct Limits {
    double range_min = 0.0, range_max = 0.0;  ///< m; what lies outside is no reading
    bool intensities = true;
  };
  explicit Sweep(const Limits& limits) : limits_(limits) {}

  /// The next beam is the first of a turn. What was gathered before is given out, marked partial when it did
  /// not begin with a turn or has less than 90 % of it.
  void begin_turn();
  /// @param step angle that this beam stands for, rad, its sign ignored: the sum of a whole turn is 2 pi
  void add(const Beam& beam, double step);
  /// The stream has a hole, or ends: what was gathered is given out as partial.
  void interrupt();
  void set_range_max(double metres) { limits_.range_max = metres; }
  /// Forgets what was gathered.
  void reset();

  std::vector<LidarScan> take_scans();
  /// scans, short_scans, partial_scans.
  void count_into(Counters& counters) const;
  /// `rejections` and those of whole turns.
  [[nodiscard]] Counters rejected(Counters rejections) const;

 private:
  [[nodiscard]] LidarScan make_scan(bool partial) const;
  [[nodiscard]] std::vector<double> unwrapped_angles() const;
  void give_out(bool partial);

  Limits limits_;
  bool whole_ = false;  // the turn in progress began at its beginning
  double covered_ = 0.0;
  std::vector<Beam> beams_;
  std::vector<LidarScan> scans_;
  std::uint64_t published_ = 0, short_ = 0, partial_ = 0;
};

}  // namespace odomcalib::drivers
