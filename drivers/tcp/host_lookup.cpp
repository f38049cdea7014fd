#include "drivers/tcp/host_lookup.hpp"

#include <netdb.h>
#include <sys/socket.h>

#include <array>
#include <mutex>
#include <system_error>
#include <thread>

namespace odomcalib::drivers {
namespace {

Error no_address(const std::string& host, const std::string& why) {
  return {ErrorCode::device, "the name \"" + host + "\" has no address: " + why, "lidar.device",
          "write the address in numbers, or see why name services (DNS, /etc/hosts, mDNS) do not know it: "
          "getent hosts " +
              host};
}

Result<std::string> looked_up(const std::string& address) {
  const HostAndPort parts = split(address);
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int failure = getaddrinfo(parts.host.c_str(), parts.port.c_str(), &hints, &found);
  if (failure != 0) return no_address(parts.host, gai_strerror(failure));
  std::array<char, NI_MAXHOST> host{};
  const int unnamed =
      getnameinfo(found->ai_addr, found->ai_addrlen, host.data(), host.size(), nullptr, 0, NI_NUMERICHOST);
  const bool brackets = found->ai_family == AF_INET6;
  freeaddrinfo(found);
  if (unnamed != 0) return no_address(parts.host, gai_strerror(unnamed));
  return (brackets ? "[" + std::string(host.data()) + "]" : std::string(host.data())) + ":" + parts.port;
}

}  // namespace

struct HostLookup::Shared {
  std::mutex mutex;
  std::optional<Result<std::string>> answer;
};

bool is_numeric(const std::string& address) {
  const HostAndPort parts = split(address);
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST;
  addrinfo* found = nullptr;
  if (parts.host.empty() || getaddrinfo(parts.host.c_str(), nullptr, &hints, &found) != 0) return false;
  freeaddrinfo(found);
  return true;
}

HostLookup::HostLookup(const std::string& address) : shared_(std::make_shared<Shared>()) {
  const auto ask = [shared = shared_, address] {
    Result<std::string> answer = looked_up(address);
    const std::scoped_lock lock(shared->mutex);
    shared->answer = std::move(answer);
  };
  try {
    std::thread(ask).detach();
  } catch (const std::system_error& error) {
    shared_->answer = no_address(split(address).host, error.what());
  }
}

std::optional<Result<std::string>> HostLookup::answer() const {
  const std::unique_lock lock(shared_->mutex, std::try_to_lock);
  return lock ? shared_->answer : std::nullopt;
}

}  // namespace odomcalib::drivers
