// Errors as values: what happened, where, and what to do next.
#pragma once

#include <cassert>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace odomcalib {

/// Closed list of failures; daemon/cli maps each to one exit status (see odomcalibctl(1)).
enum class ErrorCode {
  usage,            ///< the request itself makes no sense
  io,               ///< a file or socket could not be opened, read or written
  format,           ///< input is not in a known format, or is damaged beyond use
  missing_units,    ///< robot description lacks a unit-bearing value (diameter, track width, ticks per turn)
  empty,            ///< no usable data of a needed kind
  refused,          ///< a quality gate refused; nothing was written
  cancelled,        ///< stopped by the user or by a lost deadman
  protective_stop,  ///< the daemon stopped the robot
  device,           ///< bus or device failure
  timeout,          ///< no answer in time
  write_failed,     ///< parameter write failed, old values are in force
  write_unknown,    ///< state of the controller's parameters is unknown, operator needed
  not_running,      ///< the daemon does not answer
  not_permitted,    ///< caller lacks the right or the lease
  busy,             ///< something else runs: it can be done after that
};

struct Error {
  ErrorCode code = ErrorCode::io;
  std::string what;                       ///< what happened
  std::string where;                      ///< file and line, device, object; may be empty
  std::string remedy;                     ///< what to do next; may be empty
  std::vector<std::string> remarks = {};  ///< what was noticed before; told before the error

  /// One line for people: "where: what; remedy".
  [[nodiscard]] std::string text() const {
    std::string out = where.empty() ? what : where + ": " + what;
    return remedy.empty() ? out : out + "; " + remedy;
  }
};

/// Either a value or an Error. Access is checked by assertion: test ok() first.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : state_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return std::holds_alternative<T>(state_); }
  explicit operator bool() const { return ok(); }
  T& value() & { return std::get<T>(state_); }
  const T& value() const& { return std::get<T>(state_); }
  T&& value() && { return std::get<T>(std::move(state_)); }
  [[nodiscard]] const Error& error() const { return std::get<Error>(state_); }

 private:
  std::variant<T, Error> state_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return !error_.has_value(); }
  explicit operator bool() const { return ok(); }
  [[nodiscard]] const Error& error() const {
    assert(error_.has_value());
    return *error_;
  }

 private:
  std::optional<Error> error_;
};

}  // namespace odomcalib
