// The lidar behind its serial port or TCP connection: opens it, reopens it after it was lost, carries bytes
// both ways, and says what is wrong when no scans come.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/service/clock.hpp"
#include "drivers/byte_stream.hpp"
#include "drivers/lidar/lidar.hpp"
#include "drivers/serial/port.hpp"
#include "drivers/tcp/host_lookup.hpp"

namespace odomcalib {

class LidarLink {
 public:
  /// Errors: usage (device string, lidar type). The device may be absent.
  static Result<LidarLink> create(const std::string& device, const std::string& type);
  LidarLink(LidarLink&&) = default;
  LidarLink& operator=(LidarLink&&) = delete;
  /// Stops the device.
  ~LidarLink();

  [[nodiscard]] int fd() const { return stream_ ? stream_->fd() : -1; }
  void step(const Clock& clock);
  /// Whole turns only.
  std::vector<Scan> take_scans();

  [[nodiscard]] bool connected() const { return connected_; }
  /// Bytes that were taken from the line so far, and how often it was made or lost.
  [[nodiscard]] std::uint64_t taken() const { return taken_; }
  [[nodiscard]] std::optional<Error> problem() const;
  [[nodiscard]] drivers::Counters counters() const;
  [[nodiscard]] const std::string& device() const { return device_; }
  /// Host that is named in the device and has to be looked up; empty where its address is in numbers.
  [[nodiscard]] std::string host_name() const;
  /// Address that the name stood for when the connection was made; empty before, and without a name.
  [[nodiscard]] const std::string& found_address() const { return found_address_; }
  /// As the device states it; empty before.
  [[nodiscard]] std::string identity() const { return lidar_->identity(); }

 private:
  /// How to reach the device.
  struct Address {
    bool network = false;
    std::string path;  ///< of the port, or host:port
    unsigned baud = 0;
    drivers::ModemLines lines;
  };
  /// Counts at the beginning of the watched interval.
  struct Watch {
    double since = 0.0;
    std::uint64_t bytes = 0, good = 0;
  };
  LidarLink(std::string device, Address address, std::unique_ptr<drivers::Lidar> lidar);
  static Result<Address> address_of(const std::string& device, const drivers::LidarType& type);
  void open_when_due(double now);
  [[nodiscard]] std::optional<Result<std::string>> address_now();
  bool finish_connecting(double now);
  void lose(const Error& error, double now);
  void watch(double now);
  [[nodiscard]] Error nothing_valid(bool silent) const;

  std::string device_;
  Address address_;
  std::unique_ptr<drivers::Lidar> lidar_;
  std::unique_ptr<drivers::ByteStream> stream_;
  std::unique_ptr<drivers::HostLookup> lookup_;  // while it runs
  std::string found_address_;
  bool connected_ = false;
  std::optional<Error> problem_;       // with the connection
  std::optional<Error> data_problem_;  // with what comes over it, until something valid comes
  Watch watch_;
  double next_try_ = 0.0, opened_at_ = 0.0;
  unsigned failures_ = 0;
  std::uint64_t opened_ = 0, taken_ = 0;
};

}  // namespace odomcalib
