// A straight line through the last stamps of a lidar that turns evenly: it takes out the steps of a coarse
// device clock and measures the period.
#pragma once

#include <cstdint>
#include <deque>

namespace odomcalib::drivers {

class StampLine {
 public:
  struct Stamp {
    double t = 0.0;      ///< s, on the line
    unsigned lost = 0;   ///< turns between the last stamp and this one
    bool fresh = false;  ///< the line begins here: first stamp, or one that does not fit
  };

  /// @param stamp of a turn, s
  /// @param nominal period, s; the true one is within 20 % of it
  Stamp add(double stamp, double nominal);
  /// Measured, s; the nominal one until two stamps have come.
  [[nodiscard]] double period() const { return period_; }
  void reset() { turns_.clear(); }

 private:
  struct Turn {
    std::int64_t number = 0;
    double stamp = 0.0;
  };
  void fit();

  std::deque<Turn> turns_;
  double period_ = 0.0;
  double mean_number_ = 0.0, mean_stamp_ = 0.0;
};

}  // namespace odomcalib::drivers
