// The two parts of a network address. Only for drivers/tcp/*.cpp.
#pragma once

#include <string>

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

}  // namespace odomcalib::drivers
