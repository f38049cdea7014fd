// LCM messages leave through a thread of their own: a network whose queue is full takes one message in
// seconds, and the loop that steers must not wait for it. The loop hands messages over through a bounded
// queue without a lock. Where it is full the oldest message goes: of telemetry the newest counts.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace odomcalib {

/// Where messages leave. Made and used by the sender's thread alone; may take as long as the network does.
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
  struct Counters {
    std::uint64_t sent = 0, failed = 0;
    std::uint64_t dropped = 0;  ///< the network did not keep up
  };

  /// @param url empty: publish nothing
  /// @param open called in the sender's thread, which may outlive this when the network holds it
  Publisher(std::string url, std::string prefix, Open open = open_lcm);
  /// Waiting messages are sent where that takes no time; a thread that the network holds is left to the
  /// end of the process.
  ~Publisher();
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  /// Opens what could not be opened before: at start the network may not be there yet.
  void serve(double now);
  /// The URL that the last attempt could not open; empty: it could, or there was none.
  [[nodiscard]] std::string refused() const;
  /// Never waits. @param channel without prefix
  void send(const std::string& channel, const std::string& message);
  [[nodiscard]] Counters counters() const;
  [[nodiscard]] const std::string& prefix() const { return prefix_; }

 private:
  struct Sender;
  void make_room(std::size_t bytes);
  bool drop_oldest();

  std::string prefix_;
  std::shared_ptr<Sender> sender_;  // null: nothing is published
  std::optional<double> next_try_;  // s
  std::uint64_t dropped_ = 0;
};

}  // namespace odomcalib
