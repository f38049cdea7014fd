// SLAMTEC RPLIDAR (A, S and C series): serial or TCP, clockwise, no clock of its own.
#pragma once

#include <optional>
#include <vector>

#include "drivers/lidar/common/sweep.hpp"
#include "drivers/lidar/lidar.hpp"
#include "drivers/lidar/rplidar/startup.hpp"
#include "drivers/lidar/rplidar/stream.hpp"
#include "drivers/sample_clock.hpp"

namespace odomcalib::drivers {

class Rplidar final : public Lidar {
 public:
  using Mode = rplidar::Startup::Mode;
  /// @param guessed type of capsules of 84 bytes in a recording that begins without a descriptor; none: their
  /// distances tell
  explicit Rplidar(const LidarOptions& options, Mode mode = Mode::automatic,
                   std::optional<rplidar::PacketType> guessed = std::nullopt);

  void on_bytes(std::span<const std::uint8_t> bytes, double now) override;
  std::vector<LidarScan> take_scans() override { return sweep_.take_scans(); }
  std::vector<std::uint8_t> take_output() override { return startup_.take_output(); }
  [[nodiscard]] std::vector<std::uint8_t> stop_bytes() const override { return startup_.stop_bytes(); }
  void reset() override;
  void finish() override {
    stream_.finish();
    sweep_.interrupt();
  }
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] Counters rejected() const override { return sweep_.rejected(stream_.frames().rejected()); }
  [[nodiscard]] std::string identity() const override { return startup_.identity(); }
  [[nodiscard]] std::optional<Error> problem() const override;

 private:
  /// A capsule whose successor has not come yet.
  struct Waiting {
    std::vector<std::uint8_t> bytes;
    double t_end = 0.0;  // s, end of its measurement and transmission
  };
  void on_item(const rplidar::Item& item, double now);
  void on_packet(const rplidar::Item& item, double now);
  void on_capsule(const rplidar::Item& item, double arrival);
  void emit(const std::vector<rplidar::Point>& points, double t_end, double span);
  double date(unsigned packets, double arrival);
  bool believable(double span, unsigned& packets);
  void report_answer(const rplidar::Item& item) const;
  void report_points(const std::vector<rplidar::Point>& points) const;
  void forget_motion();

  LidarOptions options_;
  rplidar::Stream stream_;
  rplidar::Startup startup_;
  SampleClock clock_;
  Sweep sweep_;
  const rplidar::PacketFormat* format_ = nullptr;
  std::optional<double> reported_sample_s_;  // read along in a recording
  std::optional<Waiting> waiting_;
  double usual_span_ = 0.0;  // degrees per capsule
  std::optional<double> last_angle_;
};

}  // namespace odomcalib::drivers
