// The control protocol: Varlink messages (https://varlink.org). Parameters of calls are JSON values, because
// a call may carry a whole calibration, which is parsed once; those of replies are JSON text.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "proto/result.hpp"

namespace odomcalib::control {

constexpr std::string_view kInterface = "org.odomcalib.Calibration";
constexpr std::string_view kServiceInterface = "org.varlink.service";
constexpr std::size_t kLargestFrame = std::size_t{1} << 20;  ///< bytes without the terminating NUL
constexpr int kDeepestNesting = 32;                          ///< objects and arrays inside each other

/// Cuts a byte stream into NUL-terminated frames. Pure: no socket inside; never throws on received bytes.
class FrameDecoder {
 public:
  /// Every byte is accounted for: bytes_in == good + skipped + buffered().
  struct Counters {
    std::size_t bytes_in = 0;
    std::size_t good = 0;     ///< bytes of returned frames, their NUL included
    std::size_t skipped = 0;  ///< bytes of rejected frames
    std::size_t frames = 0;
    std::size_t oversized = 0;  ///< frames longer than kLargestFrame
    std::size_t empty = 0;      ///< a NUL alone
  };

  void feed(std::string_view bytes);
  /// The next whole frame without its NUL, or nullopt when more bytes are needed. An oversized frame is
  /// dropped and counted as soon as it is too long; a server closes such a connection (see
  /// Counters::oversized).
  std::optional<std::string> next();

  [[nodiscard]] std::size_t buffered() const { return buffer_.size(); }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  std::string buffer_;
  bool skipping_ = false;  // inside an oversized frame
  Counters counters_;
};

struct Call {
  std::string method = {};  ///< "org.odomcalib.Calibration.GetStatus"
  nlohmann::ordered_json parameters = nlohmann::ordered_json::object();
  bool oneway = false;  ///< the client wants no reply
  bool more = false;    ///< the client accepts replies that continue
  bool upgrade = false;

  [[nodiscard]] std::string interface() const;  ///< part of `method` before the last dot
  [[nodiscard]] std::string name() const;       ///< part of `method` behind the last dot
};

struct Reply {
  std::string parameters = "{}";
  bool continues = false;
  std::string error;  ///< qualified error name; empty on success
};

/// Frames with their NUL. `parameters` must be a JSON object text; anything else is sent as {}.
std::string encode_call(const Call& call);
std::string encode_reply(const std::string& parameters, bool continues = false);
std::string encode_error(const std::string& name, const std::string& parameters = "{}");
/// Error org.odomcalib.Calibration.<Code> with what, where and remedy.
std::string encode_error(const Error& error);

/// Error: format (no JSON object, nested too deep, no or malformed method name, a member of a wrong type).
Result<Call> decode_call(std::string_view frame);
/// Answer to a client whose frame decode_call refuses: MethodNotFound for a name without an interface,
/// InvalidParameter with the member for one of a wrong type, Format for no object; nullopt where it asked
/// for no answer.
std::optional<std::string> answer_to_malformed(std::string_view frame);
Result<Reply> decode_reply(std::string_view frame);

/// The error behind a reply with `error` set: of our own names with its code, of org.varlink.service as
/// usage, otherwise io.
Error error_of(const Reply& reply);
/// "org.odomcalib.Calibration.NotPermitted" and so on.
std::string error_name(ErrorCode code);

/// Standard errors of org.varlink.service.
std::string encode_method_not_found(const std::string& method);
std::string encode_interface_not_found(const std::string& interface);
std::string encode_invalid_parameter(const std::string& parameter);
std::string encode_method_not_implemented(const std::string& method);

/// Text of org.odomcalib.Calibration.varlink.
std::string_view interface_description();
/// Whether the interface has a method of this (unqualified) name.
bool has_method(std::string_view name);

struct ServiceInfo {
  std::string vendor = "odomcalib";
  std::string product = "odomcalibd";
  std::string version = {};
  std::string url = {};
};

/// Replies to GetInfo and GetInterfaceDescription, and to calls of unknown interfaces and methods; nullopt
/// for the methods of org.odomcalib.Calibration, which the daemon answers.
std::optional<std::string> answer_introspection(const Call& call, const ServiceInfo& info);

}  // namespace odomcalib::control
