#include "daemon/safety/lease.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace odomcalib::safety {
namespace {

Error refused(const std::string& what, const std::string& remedy) {
  return {ErrorCode::not_permitted, what, "motion lease", remedy};
}

// Clients of one group share the socket: the name keeps them from renewing each other's lease by accident.
std::string new_id() {
  std::random_device source;
  return fmt::format("{:08x}{:08x}", source(), source());
}

}  // namespace

Result<std::string> Lease::acquire(std::uint64_t owner, double now) {
  if (active())
    return Error{ErrorCode::busy, "another client holds the lease", "motion lease",
                 "wait for its end, or odomcalibctl stop"};
  id_ = new_id();
  owner_ = owner;
  renewed_ = looked_ = now;
  return id_;
}

Result<void> Lease::renew(const std::string& id, double now, std::optional<double> sent) {
  if (!holds(id)) return refused("the lease has lapsed or was never given", "acquire a new one");
  const double when = sent && std::isfinite(*sent) ? *sent : now;
  renewed_ = std::clamp(when, renewed_, std::max(renewed_, now));
  return {};
}

Result<void> Lease::release(const std::string& id) {
  if (!holds(id)) return refused("this lease is not in force", "nothing has to be released");
  id_.clear();
  return {};
}

void Lease::lost(std::uint64_t owner) {
  if (owner == owner_) id_.clear();
}

void Lease::looked(double now) {
  if (now - std::exchange(looked_, now) > kLateLook) chance_until_ = now + kSecondChance;
  const bool silent = age(now) > kLeaseTime && now > chance_until_;
  if (silent || age(now) > kLongestSilence) id_.clear();
}

}  // namespace odomcalib::safety
