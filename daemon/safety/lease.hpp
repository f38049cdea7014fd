// Rules M3 and M15: one client moves the robot at a time, and only while it says so again and again.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "proto/result.hpp"

namespace odomcalib::safety {

/// s without a renewal. M3 grants 250 ms until the wheels stand still; a control step, the quick stop and the
/// lag of the motors take about 115 ms of them.
constexpr double kLeaseTime = 0.120;

class Lease {
 public:
  /// @param owner connection of the client. Error: not_permitted while somebody else holds the lease.
  Result<std::string> acquire(std::uint64_t owner, double now);
  /// Error: not_permitted for an unknown or lapsed lease; a lapsed one cannot be renewed.
  Result<void> renew(const std::string& id, double now);
  void release(const std::string& id);
  /// The connection is gone.
  void lost(std::uint64_t owner);
  [[nodiscard]] bool holds(const std::string& id, double now) const;
  [[nodiscard]] bool active(double now) const;

 private:
  std::string id_;
  std::uint64_t owner_ = 0;
  double renewed_ = 0.0;
};

}  // namespace odomcalib::safety
