// The control socket: Varlink calls of local clients whose credentials were checked. Never blocks.
#pragma once

#include <poll.h>
#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daemon/service/settings.hpp"
#include "proto/control/control.hpp"
#include "proto/result.hpp"

namespace odomcalib {

using ClientId = std::uint64_t;

struct IncomingCall {
  ClientId client = 0;
  control::Call call;
  double arrived = 0.0;  ///< s, when it was read
  /// The robot was stopped since, at the request of whoever; a Stop itself has been carried out already.
  bool stopped_since = false;
};

class ControlServer {
 public:
  static constexpr std::size_t kMostClients = service::settings::kMostClients;
  /// Beyond those, for whoever wants to stop the robot (M15): only Stop is taken from them, and the newest
  /// takes the place of the oldest.
  static constexpr std::size_t kSpareClients = service::settings::kSpareClients;
  static constexpr std::size_t kMostOutput =
      service::settings::kMostOutput_bytes;  ///< bytes waiting for one slow client
  /// Bytes of calls that one client has sent without waiting for answers. Chosen: the largest frame, 16 times
  /// what a client sends at once (64 KiB). More ends the connection, and with it what the client does.
  static constexpr std::size_t kMostWaiting = control::kLargestFrame;
  static constexpr std::size_t kCallsPerTurn = service::settings::kCallsPerTurn;

  struct Counters {
    std::uint64_t accepted = 0, too_many = 0 /* beyond kMostClients */, not_permitted = 0, malformed = 0,
                  too_slow = 0, flooded = 0 /* beyond kMostWaiting */,
                  served = 0 /* calls taken, whatever became of them */, bytes = 0 /* read and written */;
  };

  /// Binds the socket (mode 0660, of the group where it exists: see warning()). An orphaned socket is
  /// replaced; a live one is an error. Looks the group up, which may take as long as a directory of users
  /// does: nothing later does. Errors: io, usage (path too long).
  static Result<ControlServer> create(const std::filesystem::path& path, const std::string& group);
  ~ControlServer();
  ControlServer(ControlServer&&) noexcept;
  ControlServer& operator=(ControlServer&&) noexcept;

  /// Appends what to poll: the listener and each client.
  void watch(std::vector<pollfd>& polled) const;
  /// Accepts, reads, writes; call after each poll. Begins a turn. @param now s, when what is read arrived
  void step(double now);

  /// Whether a Stop arrived since the last call of this: it is to be obeyed before anything that waits. Its
  /// answer is given in its place, when next_call() comes to it.
  [[nodiscard]] bool take_stop();
  /// The next call of this turn, in order for each client, the clients in turn, kCallsPerTurn of each at
  /// most; introspection is answered on the way. The others wait for the next turn.
  std::optional<IncomingCall> next_call();
  /// Calls wait: there is something to do without new input.
  [[nodiscard]] bool calls_wait() const;
  /// Clients that have gone since the last call.
  std::vector<ClientId> take_gone();
  /// Queues a frame for a client; nothing happens when it has gone.
  void reply(ClientId client, const std::string& frame);
  [[nodiscard]] bool connected(ClientId client) const;
  /// Its user and process, for people; empty when it has gone.
  [[nodiscard]] std::string name_of(ClientId client) const;
  /// The number of its user; nullopt when it has gone.
  [[nodiscard]] std::optional<std::uint32_t> user_of(ClientId client) const;
  [[nodiscard]] std::size_t clients() const;
  [[nodiscard]] const Counters& counters() const;
  /// Why members of the group cannot use the socket, and what helps; empty: they can.
  [[nodiscard]] const std::string& warning() const;

 private:
  struct State;
  explicit ControlServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Whether a process of this user and these groups may use the socket: root, the daemon's own user, or a
/// member of the group.
/// @param group nullopt: there is none
bool may_connect(uid_t user, std::span<const gid_t> groups, std::optional<gid_t> group);

}  // namespace odomcalib
