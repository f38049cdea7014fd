// A connection to the daemon's control socket, and the lease that keeps a motion going.
#pragma once

#include <signal.h>

#include <array>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "proto/control/control.hpp"
#include "proto/result.hpp"

namespace odomcalib::cli {

class Client {
 public:
  /// Error: not_running (with the command that starts the daemon), not_permitted.
  static Result<Client> connect(const std::string& socket);
  ~Client();
  Client(Client&& other) noexcept;
  Client& operator=(Client&&) = delete;

  /// @param parameters JSON object
  Result<void> send(const std::string& method, nlohmann::ordered_json parameters, bool more = false);
  /// The next reply, or nullopt when none came within the time. Errors: not_running (connection lost),
  /// format.
  Result<std::optional<control::Reply>> receive(int timeout_ms);
  /// One call with one reply. @return its parameters; the daemon's error as ours
  Result<nlohmann::ordered_json> call(const std::string& method,
                                      nlohmann::ordered_json parameters = nlohmann::ordered_json::object(),
                                      int timeout_ms = 5000);

 private:
  explicit Client(int fd) : fd_(fd) {}
  int fd_;
  control::FrameDecoder decoder_;
};

/// One call on a connection of its own. Errors: those of Client.
Result<nlohmann::ordered_json> call_once(const std::string& socket, const std::string& method,
                                         nlohmann::ordered_json parameters = nlohmann::ordered_json::object(),
                                         int timeout_ms = 5000);

/// While one lives, Ctrl-C, Ctrl-Z, SIGTERM and SIGHUP ask for the end of the method that runs instead of
/// ending the process, and a later method is not begun any more.
class SignalsCaught {
 public:
  SignalsCaught();
  ~SignalsCaught();
  SignalsCaught(const SignalsCaught&) = delete;
  SignalsCaught& operator=(const SignalsCaught&) = delete;

 private:
  static constexpr std::array kNumbers{SIGINT, SIGTERM, SIGHUP, SIGTSTP};
  std::array<struct sigaction, 4> before_{};
};

enum class WhenInterrupted {
  stop,    ///< the robot is stopped and the call given up
  finish,  ///< what has begun comes to its end; what has not is not begun
  begin    ///< even a call that has not begun is begun, and comes to its end
};

/// Runs a method that needs the lease: acquires it, renews it every 30 ms on a connection of its own, and
/// lets go of it on Ctrl-C, Ctrl-Z, SIGTERM and SIGHUP. A suspended or killed process renews nothing, and the
/// robot stops.
/// @param parameters JSON object without "lease"
/// @param progress called with each progress object
/// @param on outlives the call: for what the daemon ends with the connection that asked for it; null: a
/// connection of the call's own
Result<nlohmann::ordered_json> call_with_lease(
    const std::string& socket, const std::string& method, nlohmann::ordered_json parameters,
    const std::function<void(const nlohmann::ordered_json&)>& progress,
    WhenInterrupted interrupted = WhenInterrupted::stop, Client* on = nullptr);

/// All of an answer. Error format: it is no object, or lacks the member.
/// @param member empty: none is asked for
Result<nlohmann::ordered_json> answer_with(nlohmann::ordered_json answer, const std::string& method,
                                           const std::string& member);

/// Whether a row of the checks stands in the way. An outcome that is not known here does.
bool stands_in_the_way(const nlohmann::ordered_json& check);

}  // namespace odomcalib::cli
