// What leaves the daemon over LCM.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace odomcalib {

/// Where messages leave.
class Outlet {
 public:
  Outlet() = default;
  virtual ~Outlet() = default;
  Outlet(const Outlet&) = delete;
  Outlet& operator=(const Outlet&) = delete;
  /// False: it was not sent.
  virtual bool publish(const std::string& channel, const std::string& message) = 0;
};

/// LCM; null when it cannot be opened.
std::unique_ptr<Outlet> open_lcm(const std::string& url);

/// Sends over LCM. Without a network, a route or a working URL it counts and does nothing, and tries again
/// later: telemetry never delays or stops the service.
class Publisher {
 public:
  using Open = std::function<std::unique_ptr<Outlet>(const std::string& url)>;
  /// @param url empty: publish nothing
  Publisher(std::string url, std::string prefix, Open open = open_lcm);
  /// Opens what could not be opened before: at start the network may not be there yet.
  void serve(double now);
  /// @param channel without prefix
  void send(const std::string& channel, const std::string& message);
  [[nodiscard]] std::uint64_t sent() const { return sent_; }
  [[nodiscard]] std::uint64_t failed() const { return failed_; }
  [[nodiscard]] const std::string& prefix() const { return prefix_; }

 private:
  std::string url_, prefix_;
  Open open_;
  std::unique_ptr<Outlet> outlet_;
  std::optional<double> next_try_;  // s
  std::uint64_t sent_ = 0, failed_ = 0;
};

}  // namespace odomcalib
