// Rules M3 and M15: one client moves the robot at a time, and only while it says so again and again.
//
// Whether a client has fallen silent can be judged only by a daemon that listens. When the daemon itself was
// held up, renewals lie unread in the socket, or a pause of the whole machine has kept the client from
// sending them: what has arrived is read first, and a client that had no chance is given one. A robot that
// stops in the middle of a drive because of the daemon's own delay would have stopped without a cause; that
// the daemon was late is a fault of its own and judged elsewhere (Service::Impl::watch_loop).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "daemon/safety/settings.hpp"
#include "proto/result.hpp"

namespace odomcalib::safety {

using settings::kLateLook;
using settings::kLeaseTime;
using settings::kLongestSilence;
using settings::kSecondChance;

class Lease {
 public:
  /// @param owner connection of the client. Error: not_permitted while somebody else holds the lease.
  Result<std::string> acquire(std::uint64_t owner, double now);
  /// @param sent when the client sent it, s on the clock of `now`; nullopt: just now
  /// Error: not_permitted for an unknown or lapsed lease; a lapsed one cannot be renewed.
  Result<void> renew(const std::string& id, double now, std::optional<double> sent = {});
  /// Error: not_permitted for an unknown or lapsed lease; the lease of another client stays.
  Result<void> release(const std::string& id);
  /// The connection is gone.
  void lost(std::uint64_t owner);
  /// Everything that had arrived was read: does it lapse?
  void looked(double now);
  [[nodiscard]] bool holds(const std::string& id) const { return active() && id == id_; }
  [[nodiscard]] bool active() const { return !id_.empty(); }
  /// s since the last renewal was sent.
  [[nodiscard]] double age(double now) const { return now - renewed_; }

 private:
  std::string id_;
  std::uint64_t owner_ = 0;
  double renewed_ = 0.0, looked_ = 0.0, chance_until_ = 0.0;
};

}  // namespace odomcalib::safety
