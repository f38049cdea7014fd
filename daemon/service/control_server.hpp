// The control socket: Varlink calls of local clients whose credentials were checked. Never blocks.
#pragma once

#include <poll.h>
#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "proto/control/control.hpp"
#include "proto/result.hpp"

namespace odomcalib {

using ClientId = std::uint64_t;

struct IncomingCall {
  ClientId client = 0;
  control::Call call;
};

class ControlServer {
 public:
  static constexpr std::size_t kMostClients = 8;
  /// Beyond those, for whoever wants to stop the robot (M15): only Stop is taken from them, and the newest
  /// takes the place of the oldest.
  static constexpr std::size_t kSpareClients = 2;
  static constexpr std::size_t kMostOutput = std::size_t{8} << 20;  ///< bytes waiting for one slow client

  struct Counters {
    std::uint64_t accepted = 0, too_many = 0 /* beyond kMostClients */, not_permitted = 0, malformed = 0,
                  too_slow = 0;
  };

  /// Binds the socket (mode 0660, of the group where it exists). An orphaned socket is replaced; a live one
  /// is an error. Errors: io, usage (path too long).
  static Result<ControlServer> create(const std::filesystem::path& path, const std::string& group);
  ~ControlServer();
  ControlServer(ControlServer&&) noexcept;
  ControlServer& operator=(ControlServer&&) noexcept;

  /// Appends what to poll: the listener and each client.
  void watch(std::vector<pollfd>& polled) const;
  /// Accepts, reads, writes; call after each poll.
  void step();

  /// Calls that arrived, in order for each client; introspection is answered already.
  std::vector<IncomingCall> take_calls();
  /// Clients that have gone since the last call.
  std::vector<ClientId> take_gone();
  /// Queues a frame for a client; nothing happens when it has gone.
  void reply(ClientId client, const std::string& frame);
  [[nodiscard]] bool connected(ClientId client) const;
  [[nodiscard]] std::size_t clients() const;
  [[nodiscard]] const Counters& counters() const;

 private:
  struct State;
  explicit ControlServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Whether a process of this user and group may use the socket: root, the daemon's own user, or a member of
/// the group.
bool may_connect(uid_t uid, gid_t gid, const std::string& group);

}  // namespace odomcalib
