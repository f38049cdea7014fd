// Dates the packets of a lidar that has no clock of its own. Samples are equidistant, so counted samples are
// the clock: its rate is measured and its offset is the lower envelope of the arrivals, because a transport
// can only add delay.
#pragma once

namespace odomcalib::drivers {

class SampleClock {
 public:
  /// @param device_time whether to count samples only, from 0, for recordings without arrival times
  explicit SampleClock(bool device_time) : device_time_(device_time) {}

  struct Stamp {
    double t = 0.0;          ///< s, never later than the arrival
    bool continuous = true;  ///< false after a hole in the stream: what came before does not belong to it
  };

  /// @param nominal time since the packet before, as the number of samples and the nominal rate tell, s
  /// @param arrival of the packet on the caller's clock, s
  Stamp on_packet(double nominal, double arrival);

  /// True length of a nominal second.
  [[nodiscard]] double rate() const { return rate_; }
  void reset();

 private:
  void start(double arrival);
  void learn(double late, double nominal);

  bool device_time_;
  bool running_ = false;
  double t_ = 0.0;     // s, envelope at the last packet
  double rate_ = 1.0;  // measured / nominal
  // Window in progress: nominal seconds in it, and the least lateness seen.
  double window_ = 0.0, least_late_ = 0.0;
};

}  // namespace odomcalib::drivers
