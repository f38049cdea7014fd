// The numeric address behind the name of a host. Name services may take ten seconds to say that they know
// nothing, so they are asked beside the caller.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "proto/result.hpp"

namespace odomcalib::drivers {

struct HostAndPort {
  std::string host, port;
};

/// Splits "1.2.3.4:80", "[::1]:80" and "lidar.local:80"; both empty where there is no port.
inline HostAndPort split(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos) return {};
  std::string host = address.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  return {host, address.substr(colon + 1)};
}

/// Whether an address "HOST:PORT" has its host in numbers: nothing has to be looked up.
bool is_numeric(const std::string& address);

/// One question, asked from the construction on. Whoever no longer waits for the answer is not held up.
class HostLookup {
 public:
  /// @param address "sick.local:2112"
  explicit HostLookup(const std::string& address);

  /// The same with the host in numbers, for open_tcp(); nullopt: no answer yet.
  /// Errors: device (the name has no address, or nobody can be asked), usage (no port).
  [[nodiscard]] std::optional<Result<std::string>> answer() const;

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
};

}  // namespace odomcalib::drivers
