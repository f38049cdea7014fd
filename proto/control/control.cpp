#include "proto/control/control.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

namespace odomcalib::control {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr std::array<std::pair<ErrorCode, std::string_view>, 15> kErrorNames{{
    {ErrorCode::usage, "Usage"},
    {ErrorCode::io, "Io"},
    {ErrorCode::format, "Format"},
    {ErrorCode::missing_units, "MissingUnits"},
    {ErrorCode::empty, "Empty"},
    {ErrorCode::refused, "Refused"},
    {ErrorCode::cancelled, "Cancelled"},
    {ErrorCode::protective_stop, "ProtectiveStop"},
    {ErrorCode::device, "Device"},
    {ErrorCode::timeout, "Timeout"},
    {ErrorCode::write_failed, "WriteFailed"},
    {ErrorCode::write_unknown, "WriteUnknown"},
    {ErrorCode::not_running, "NotRunning"},
    {ErrorCode::not_permitted, "NotPermitted"},
    {ErrorCode::busy, "Busy"},
}};

Error format_error(const std::string& what) {
  return {ErrorCode::format, what, "control message", "send one JSON object per NUL-terminated message"};
}

/// Deepest nesting of brackets outside of strings; cheap, and before any tree is built.
int nesting(std::string_view text) {
  int depth = 0;
  int deepest = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string && c == '\\') {
      ++i;
    } else if (c == '"') {
      in_string = !in_string;
    } else if (!in_string && (c == '{' || c == '[')) {
      deepest = std::max(deepest, ++depth);
    } else if (!in_string && (c == '}' || c == ']')) {
      --depth;
    }
  }
  return deepest;
}

/// A JSON object, or null when the text is none.
ordered_json parse_object(std::string_view text) {
  if (text.size() > kLargestFrame || nesting(text) > kDeepestNesting) return nullptr;
  auto value = ordered_json::parse(text, nullptr, false);
  return value.is_object() ? value : ordered_json(nullptr);
}

ordered_json object_or_empty(const std::string& text) {
  auto value = parse_object(text);
  return value.is_null() ? ordered_json::object() : value;
}

std::string dump(const ordered_json& value) {
  return value.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

std::string frame(const ordered_json& value) {
  std::string text = dump(value);
  text += '\0';
  return text;
}

bool is_name(std::string_view text, bool first_may_be_digit) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  return !text.empty() && (letter(text[0]) || (first_may_be_digit && digit(text[0]))) &&
         std::all_of(text.begin(), text.end(),
                     [&](char c) { return letter(c) || digit(c) || c == '-' || c == '_'; });
}

/// "org.example.Name": at least two parts, the last one (the member) starting with a letter.
bool is_qualified_name(std::string_view text) {
  const std::size_t dot = text.rfind('.');
  if (dot == std::string_view::npos || !is_name(text.substr(dot + 1), false)) return false;
  std::string_view interface = text.substr(0, dot);
  for (;;) {
    const std::size_t next = interface.find('.');
    if (!is_name(interface.substr(0, next), true)) return false;
    if (next == std::string_view::npos) return true;
    interface.remove_prefix(next + 1);
  }
}

/// Reads an optional flag; false when the member exists and is no boolean.
bool take_flag(const ordered_json& object, const char* name, bool& out) {
  const auto found = object.find(name);
  if (found == object.end() || found->is_null()) return true;
  if (!found->is_boolean()) return false;
  out = found->get<bool>();
  return true;
}

/// @return false when they are no object; leaves `out` where there are none
bool take_parameters(ordered_json& object, ordered_json& out) {
  const auto found = object.find("parameters");
  if (found == object.end() || found->is_null()) return true;
  if (!found->is_object()) return false;
  out = std::move(*found);
  return true;
}

std::string text_member(const ordered_json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::string service_error(const char* name, const char* member, const std::string& value) {
  return encode_error(std::string(kServiceInterface) + "." + name, dump(ordered_json{{member, value}}));
}

std::string encode_info(const ServiceInfo& info) {
  return encode_reply(dump(ordered_json{{"vendor", info.vendor},
                                        {"product", info.product},
                                        {"version", info.version},
                                        {"url", info.url},
                                        {"interfaces", {kServiceInterface, kInterface}}}));
}

constexpr std::string_view kServiceDescription = R"(# What every Varlink service offers
interface org.varlink.service

method GetInfo() -> (
  vendor: string,
  product: string,
  version: string,
  url: string,
  interfaces: []string
)

method GetInterfaceDescription(interface: string) -> (description: string)

error InterfaceNotFound (interface: string)
error MethodNotFound (method: string)
error MethodNotImplemented (method: string)
error InvalidParameter (parameter: string)
error PermissionDenied ()
error ExpectedMore ()
)";

std::string encode_description(const Call& call) {
  const auto found = call.parameters.find("interface");
  if (found == call.parameters.end() || !found->is_string()) return encode_invalid_parameter("interface");
  const auto interface = found->get<std::string>();
  if (interface == kInterface)
    return encode_reply(dump(ordered_json{{"description", interface_description()}}));
  if (interface == kServiceInterface)
    return encode_reply(dump(ordered_json{{"description", kServiceDescription}}));
  return encode_interface_not_found(interface);
}

}  // namespace

void FrameDecoder::feed(std::string_view bytes) {
  counters_.bytes_in += bytes.size();
  if (skipping_) {
    const std::size_t end = bytes.find('\0');
    const std::size_t skipped = end == std::string_view::npos ? bytes.size() : end + 1;
    counters_.skipped += skipped;
    bytes.remove_prefix(skipped);
    skipping_ = end == std::string_view::npos;
  }
  buffer_.append(bytes);
}

std::optional<std::string> FrameDecoder::next() {
  while (!buffer_.empty()) {
    const std::size_t end = buffer_.find('\0');
    if (end == std::string::npos && buffer_.size() <= kLargestFrame) return std::nullopt;
    const std::size_t size = end == std::string::npos ? buffer_.size() : end + 1;
    std::string found = buffer_.substr(0, std::min(end, size));
    buffer_.erase(0, size);
    if (found.empty() || found.size() > kLargestFrame) {
      ++(found.empty() ? counters_.empty : counters_.oversized);
      counters_.skipped += size;
      skipping_ = end == std::string::npos;
      continue;
    }
    counters_.good += size;
    ++counters_.frames;
    return found;
  }
  return std::nullopt;
}

std::string Call::interface() const { return method.substr(0, method.rfind('.')); }

std::string Call::name() const {
  const std::size_t dot = method.rfind('.');
  return dot == std::string::npos ? method : method.substr(dot + 1);
}

std::string encode_call(const Call& call) {
  ordered_json message{{"method", call.method}, {"parameters", call.parameters}};
  if (call.oneway) message["oneway"] = true;
  if (call.more) message["more"] = true;
  if (call.upgrade) message["upgrade"] = true;
  return frame(message);
}

std::string encode_reply(const std::string& parameters, bool continues) {
  ordered_json message{{"parameters", object_or_empty(parameters)}};
  if (continues) message["continues"] = true;
  return frame(message);
}

std::string encode_error(const std::string& name, const std::string& parameters) {
  return frame({{"error", name}, {"parameters", object_or_empty(parameters)}});
}

std::string encode_error(const Error& error) {
  return encode_error(
      error_name(error.code),
      dump(ordered_json{{"what", error.what}, {"where", error.where}, {"remedy", error.remedy}}));
}

Result<Call> decode_call(std::string_view text) {
  auto object = parse_object(text);
  if (object.is_null()) return format_error("call is not a JSON object or is nested too deep");
  Call call;
  call.method = text_member(object, "method");
  if (!is_qualified_name(call.method)) return format_error("call has no qualified \"method\"");
  if (!take_parameters(object, call.parameters)) return format_error("\"parameters\" is not an object");
  if (!take_flag(object, "oneway", call.oneway) || !take_flag(object, "more", call.more) ||
      !take_flag(object, "upgrade", call.upgrade))
    return format_error("\"oneway\", \"more\" or \"upgrade\" is not a boolean");
  return call;
}

std::optional<std::string> answer_to_malformed(std::string_view text) {
  auto object = parse_object(text);
  if (object.is_null()) return encode_error(decode_call(text).error());
  bool oneway = false, flag = false;
  const bool known = take_flag(object, "oneway", oneway);
  if (oneway) return std::nullopt;
  const std::string method = text_member(object, "method");
  if (method.empty()) return encode_invalid_parameter("method");
  if (!is_qualified_name(method)) return encode_method_not_found(method);
  ordered_json parameters;
  if (!take_parameters(object, parameters)) return encode_invalid_parameter("parameters");
  if (!known) return encode_invalid_parameter("oneway");
  return encode_invalid_parameter(take_flag(object, "more", flag) ? "upgrade" : "more");
}

Result<Reply> decode_reply(std::string_view text) {
  auto object = parse_object(text);
  if (object.is_null()) return format_error("reply is not a JSON object or is nested too deep");
  Reply reply;
  if (object.contains("error") && !is_qualified_name(text_member(object, "error")))
    return format_error("\"error\" is not a qualified name");
  reply.error = text_member(object, "error");
  ordered_json parameters = ordered_json::object();
  if (!take_parameters(object, parameters)) return format_error("\"parameters\" is not an object");
  if (!take_flag(object, "continues", reply.continues)) return format_error("\"continues\" is not a boolean");
  reply.parameters = dump(parameters);
  return reply;
}

std::string error_name(ErrorCode code) {
  for (const auto& [known, name] : kErrorNames)
    if (known == code) return std::string(kInterface) + "." + std::string(name);
  return std::string(kInterface) + ".Io";
}

Error error_of(const Reply& reply) {
  const auto parameters = object_or_empty(reply.parameters);
  for (const auto& [code, name] : kErrorNames)
    if (reply.error == error_name(code))
      return {code, text_member(parameters, "what"), text_member(parameters, "where"),
              text_member(parameters, "remedy")};
  const bool misuse = reply.error.starts_with(std::string(kServiceInterface) + ".");
  return {misuse ? ErrorCode::usage : ErrorCode::io,
          "daemon answered \"" + reply.error + "\" " + dump(parameters), "control socket",
          "check that odomcalibctl and odomcalibd are of one version"};
}

std::string encode_method_not_found(const std::string& method) {
  return service_error("MethodNotFound", "method", method);
}
std::string encode_interface_not_found(const std::string& interface) {
  return service_error("InterfaceNotFound", "interface", interface);
}
std::string encode_invalid_parameter(const std::string& parameter) {
  return service_error("InvalidParameter", "parameter", parameter);
}
std::string encode_method_not_implemented(const std::string& method) {
  return service_error("MethodNotImplemented", "method", method);
}

bool has_method(std::string_view name) {
  return is_name(name, false) &&
         interface_description().find("\nmethod " + std::string(name) + "(") != std::string_view::npos;
}

std::optional<std::string> answer_introspection(const Call& call, const ServiceInfo& info) {
  if (call.interface() == kInterface)
    return has_method(call.name()) ? std::nullopt : std::optional(encode_method_not_found(call.method));
  if (call.interface() != kServiceInterface) return encode_interface_not_found(call.interface());
  if (call.name() == "GetInfo") return encode_info(info);
  if (call.name() == "GetInterfaceDescription") return encode_description(call);
  return encode_method_not_found(call.method);
}

}  // namespace odomcalib::control
